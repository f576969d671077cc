// The newest frame of the camera over the arena: one is fetched at a time, and what comes meanwhile is passed over.

import { withToken } from './api.js';
import { changed, state } from './state.js';

/** Steps that show the floor as it is now. */
const LIVE_STEPS = ['drive', 'base'];
/** A picture that has not come after this long is given up, milliseconds. */
const PATIENCE = 5000;

let fetching = false;

/** Fetches the newest frame if a newer one is there than is shown, and somebody looks. */
export async function followFrames() {
  const { camera } = state;
  if (!camera?.source || camera.frame === null) {
    if (state.live) forget();
    return;
  }
  const isSeen = LIVE_STEPS.includes(state.step) && !document.hidden;
  if (fetching || !isSeen || state.live?.number === camera.frame) return;
  fetching = true;
  try {
    await fetchFrame(camera.frame);
  } catch {
    // The next state tries again.
  }
  fetching = false;
}

async function fetchFrame(number) {
  const response = await fetch(withToken('/api/camera/frame'), { signal: AbortSignal.timeout(PATIENCE) });
  if (!response.ok) return;
  const url = URL.createObjectURL(await response.blob());
  const picture = new Image();
  picture.src = url;
  try {
    // What is not decoded yet would flicker.
    await picture.decode();
  } catch (error) {
    URL.revokeObjectURL(url);
    throw error;
  }
  forget();
  state.live = { number, url, width: picture.naturalWidth, height: picture.naturalHeight };
  changed();
}

function forget() {
  if (state.live) URL.revokeObjectURL(state.live.url);
  state.live = null;
  changed();
}

/** The frame that the stage shows in place of the photo, with the arena's corners in it; null if it shows none. */
export function liveFrame() {
  const { live, camera, photo } = state;
  if (!live || !camera?.source || !LIVE_STEPS.includes(state.step)) return null;
  const isPhoto = photo && photo.width === live.width && photo.height === live.height;
  const own = isPhoto ? state.corners ?? state.detection?.corners_px : null;
  return { ...live, corners: camera.corners_px ?? own ?? null };
}
