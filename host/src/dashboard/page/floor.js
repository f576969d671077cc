// From the floor to the picture and back: the homography of the arena's corners, and shapes on the floor.

/** A map between floor (metres) and picture (pixels); without corners a plain one of 500 px a metre. */
export function floorMap(arena, corners, origin = [0, 0]) {
  const { width: w, height: h } = arena;
  const from = [[0, 0], [w, 0], [w, h], [0, h]];
  const scale = 500;
  const to = corners ?? from.map(([x, y]) => [x * scale, (h - y) * scale]);
  const forward = homography(from, to);
  const back = inverse(forward);
  return {
    corners: to,
    toPicture: ([x, y]) => apply(forward, [x - origin[0], y - origin[1]]),
    toFloor: (point) => apply(back, point).map((value, axis) => value + origin[axis]),
  };
}

function homography(from, to) {
  const rows = [];
  from.forEach(([x, y], index) => {
    const [u, v] = to[index];
    rows.push([x, y, 1, 0, 0, 0, -u * x, -u * y, u], [0, 0, 0, x, y, 1, -v * x, -v * y, v]);
  });
  for (let i = 0; i < 8; i += 1) {
    let pivot = i;
    for (let j = i + 1; j < 8; j += 1) if (Math.abs(rows[j][i]) > Math.abs(rows[pivot][i])) pivot = j;
    [rows[i], rows[pivot]] = [rows[pivot], rows[i]];
    for (let j = 0; j < 8; j += 1) {
      if (j === i) continue;
      const factor = rows[j][i] / rows[i][i];
      for (let k = i; k < 9; k += 1) rows[j][k] -= factor * rows[i][k];
    }
  }
  return [...rows.map((row, i) => row[8] / row[i]), 1];
}

function inverse([a, b, c, d, e, f, g, h, i]) {
  return [e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g, c * d - a * f, d * h - e * g, b * g - a * h, a * e - b * d];
}

function apply([a, b, c, d, e, f, g, h, i], [x, y]) {
  const w = g * x + h * y + i;
  return [(a * x + b * y + c) / w, (d * x + e * y + f) / w];
}

export const isBox = (obstacle) => Array.isArray(obstacle);

export function circlePoints([x, y], radius, count = 48) {
  return Array.from({ length: count }, (_, i) => {
    const angle = (i / count) * 2 * Math.PI;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/** The outline of an obstacle of any shape. */
export function outline(obstacle) {
  if (isBox(obstacle)) {
    const [x0, y0, x1, y1] = obstacle;
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  }
  return obstacle.circle ? circlePoints(obstacle.circle, obstacle.circle[2]) : obstacle.polygon;
}

/** The outline of an obstacle inflated by `by` metres: upright rectangles by a square if that is wanted, all
 * else by a disc. */
export function inflated(obstacle, by, square) {
  if (isBox(obstacle) && square) {
    const [x0, y0, x1, y1] = obstacle;
    return outline([x0 - by, y0 - by, x1 + by, y1 + by]);
  }
  if (obstacle.circle) return circlePoints(obstacle.circle, obstacle.circle[2] + by);
  const list = outline(obstacle);
  const area = list.reduce((sum, [x, y], i) => {
    const [u, v] = list[(i + 1) % list.length];
    return sum + x * v - u * y;
  }, 0);
  const corners = area < 0 ? [...list].reverse() : list;
  const normal = ([x, y], [u, v]) => Math.atan2(x - u, v - y);
  return corners.flatMap((at, i) => {
    const from = normal(corners.at(i - 1), at);
    const turn = wrapped(normal(at, corners[(i + 1) % corners.length]) - from);
    const steps = turn > 0 ? Math.ceil(turn / 0.2) : 1;
    return Array.from({ length: steps + 1 }, (_, step) => {
      const angle = from + (turn * step) / steps;
      return [at[0] + by * Math.cos(angle), at[1] + by * Math.sin(angle)];
    });
  });
}

const wrapped = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));

/** The least upright rectangle around an obstacle. */
export function bounds(obstacle) {
  if (isBox(obstacle)) return obstacle;
  const points = outline(obstacle);
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  return [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
}

/** How much of what two upright rectangles cover together they share, 0 to 1. */
export function share(a, b) {
  const common = Math.max(Math.min(a[2], b[2]) - Math.max(a[0], b[0]), 0) * Math.max(Math.min(a[3], b[3]) - Math.max(a[1], b[1]), 0);
  const area = ([x0, y0, x1, y1]) => (x1 - x0) * (y1 - y0);
  return common / (area(a) + area(b) - common);
}

export function moved(obstacle, dx, dy) {
  if (isBox(obstacle)) return [obstacle[0] + dx, obstacle[1] + dy, obstacle[2] + dx, obstacle[3] + dy];
  if (obstacle.circle) return { ...obstacle, circle: [obstacle.circle[0] + dx, obstacle.circle[1] + dy, obstacle.circle[2]] };
  return { ...obstacle, polygon: obstacle.polygon.map(([x, y]) => [x + dx, y + dy]) };
}

/** No margin, in the form that the obstacle has it: an upright rectangle one for each edge. */
export const noMargin = (obstacle) => (isBox(obstacle) ? [0, 0, 0, 0] : 0);

/** Where two obstacles, or one and the arena's border (null), come nearest: two points. */
export function gapBetween([first, second], scene) {
  const own = scene.obstacles;
  const [ox, oy] = scene.origin ?? [0, 0];
  const a = bounds(own[first ?? second]);
  if (first === null || second === null) {
    const right = ox + scene.arena.width;
    const top = oy + scene.arena.height;
    const middle = [(a[0] + a[2]) / 2, (a[1] + a[3]) / 2];
    const ways = [
      [a[0] - ox, [ox, middle[1]], [a[0], middle[1]]], [right - a[2], [a[2], middle[1]], [right, middle[1]]],
      [a[1] - oy, [middle[0], oy], [middle[0], a[1]]], [top - a[3], [middle[0], a[3]], [middle[0], top]],
    ].filter(([width]) => width > 1e-6).sort((one, other) => one[0] - other[0]);
    return ways.length ? ways[0].slice(1) : null;
  }
  const b = bounds(own[second]);
  const near = (axis) => {
    const low = Math.max(a[axis], b[axis]);
    const high = Math.min(a[axis + 2], b[axis + 2]);
    return low > high ? [Math.min(a[axis + 2], b[axis + 2]), Math.max(a[axis], b[axis])] : [(low + high) / 2, (low + high) / 2];
  };
  const [xs, ys] = [near(0), near(1)];
  const flip = (a[0] < b[0]) !== (a[1] < b[1]) && xs[0] !== xs[1] && ys[0] !== ys[1];
  return flip ? [[xs[0], ys[1]], [xs[1], ys[0]]] : [[xs[0], ys[0]], [xs[1], ys[1]]];
}

export const round = (value, places = 3) => Number(value.toFixed(places));
export const degrees = (radians) => (radians * 180) / Math.PI;
export const radians = (angle) => (angle * Math.PI) / 180;
export const centimetres = (metres) => (metres * 100).toFixed(1);
export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);
