// A photo by the camera of this computer or phone.

import { find, showProblem } from './dom.js';

const dialog = find('camera');
const video = find('camera-view');
let stream = null;
let take = () => {};

export async function openCamera(onPhoto) {
  take = onPhoto;
  showProblem(find('camera-problem'), null);
  // Not modal: STOP stays in reach.
  dialog.show();
  try {
    const wanted = { video: { facingMode: 'environment', width: { ideal: 1920 }, height: { ideal: 1440 } } };
    stream = await navigator.mediaDevices.getUserMedia(wanted);
    video.srcObject = stream;
    await video.play();
  } catch (error) {
    // Browsers lend a camera to pages of their own computer alone, unless they are encrypted.
    const problem = window.isSecureContext
      ? { message: `no camera can be used (${error.name})`, help: 'allow it in the browser, or choose a file' }
      : { message: 'the browser lends no camera to a page from another computer', help: 'choose File: a phone offers its camera there' };
    showProblem(find('camera-problem'), problem);
  }
}

function close() {
  for (const track of stream?.getTracks() ?? []) track.stop();
  stream = null;
  video.srcObject = null;
}

dialog.addEventListener('close', close);
dialog.addEventListener('keydown', (event) => { if (event.key === 'Escape') dialog.close(); });
find('camera-close').addEventListener('click', () => dialog.close());
find('camera-take').addEventListener('click', () => {
  if (!video.videoWidth) return;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
  canvas.getContext('2d').drawImage(video, 0, 0);
  dialog.close();
  canvas.toBlob((blob) => take(blob), 'image/png');
});
