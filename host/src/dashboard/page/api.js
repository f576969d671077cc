// Requests to the server and the socket from it.

let token = document.querySelector('meta[name=wmr-token]').content;

export const withToken = (path) => `${path}${path.includes('?') ? '&' : '?'}t=${token}`;

/** Heavy requests can be given up. */
const HEAVY = ['photo', 'detect', 'steps', 'plan'].map((what) => `/api/${what}`);
let heavy = new AbortController();

/** Gives up what the program works on for this page. */
export function giveUp() {
  heavy.abort();
  heavy = new AbortController();
  return post('cancel');
}

/** A request; throws the server's error as { code, message, help }. */
export async function request(method, path, body, type = 'application/json') {
  const headers = { authorization: `Bearer ${token}` };
  if (body !== undefined) headers['content-type'] = type;
  const sent = body === undefined || type !== 'application/json' ? body : JSON.stringify(body);
  let response;
  try {
    response = await fetch(path, { method, headers, body: sent, signal: method === 'POST' && HEAVY.includes(path) ? heavy.signal : undefined });
  } catch (error) {
    if (error.name === 'AbortError') throw { code: 'http.cancelled', message: 'this was given up', help: '' };
    throw { code: 'page.offline', message: 'the program does not answer', help: 'start it again: wmr serve' };
  }
  const document = await response.json().catch(() => null);
  if (response.ok && document) return document;
  throw document?.error ?? { code: 'page', message: `the program answered ${response.status}`, help: '' };
}

export const post = (what, body) => request('POST', `/api/${what}`, body);
export const getJson = (what) => request('GET', `/api/${what}`);
export const getState = () => request('GET', '/api/state');
export const sendPhoto = (blob) => request('POST', '/api/photo', blob, blob.type.startsWith('image/') ? blob.type : 'application/octet-stream');

export const getPhoto = async () => (await fetch(withToken('/api/photo'))).blob();

/** Keeps a socket open: `onState` gets each state, `onLink` whether there is a link and whether to a
 * program that was started again. */
export function listen(onState, onLink) {
  let known = token;
  const open = () => {
    const socket = new WebSocket(withToken(`ws://${location.host}/ws`));
    socket.onopen = () => {
      onLink(true, known !== token);
      known = token;
    };
    socket.onmessage = (message) => onState(JSON.parse(message.data));
    socket.onclose = () => {
      onLink(false, false);
      setTimeout(async () => {
        await renew();
        open();
      }, 500);
    };
  };
  open();
}

/** A program that was started again has another token, which its page carries. */
async function renew() {
  try {
    const text = await (await fetch(location.href, { cache: 'no-store' })).text();
    token = /name="wmr-token" content="([0-9a-f]+)"/.exec(text)?.[1] ?? token;
  } catch {
    // It is not there yet.
  }
}
