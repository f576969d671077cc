// Photos drawn for a test in the browser, by other code than looks at them. Files of the pictures as bytes.

/** 2.0 × 1.25 m of floor at 400 pixels a metre, lit from one side, noisy and a little blurred, with an upright
 * and a turned box that have soft shadows. */
export const TURNED = {
  arena: [2.0, 1.25],
  upright: [0.35, 0.3, 0.6, 0.75],
  turned: { middle: [1.3, 0.7], size: [0.5, 0.24], angle: 0.45 },
};

/** With `blur` all of it is, by so many pixels. */
export async function turnedBoxPhoto(page, blur = 0) {
  const bytes = await page.evaluate(async ([{ arena: [w, h], upright, turned }, all]) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [1000, 700];
    const draw = canvas.getContext('2d');
    const [scale, left, top] = [400, 100, 100];
    const at = ([x, y]) => [left + x * scale, top + (h - y) * scale];
    const fill = (colour, points, shift = 0) => {
      draw.fillStyle = colour;
      draw.beginPath();
      for (const [x, y] of points.map(at)) draw.lineTo(x + shift, y + shift);
      draw.fill();
    };
    const rect = ([x0, y0, x1, y1]) => [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    fill('#cfcabf', rect([-1, -1, w + 1, h + 1]));
    fill('#262422', rect([-0.05, -0.05, w + 0.05, h + 0.05]));
    fill('#d6d1c7', rect([0, 0, w, h]));
    const { middle: [mx, my], size: [a, b], angle } = turned;
    const corner = ([i, j]) => [mx + (i * a * Math.cos(angle) - j * b * Math.sin(angle)) / 2, my + (i * a * Math.sin(angle) + j * b * Math.cos(angle)) / 2];
    const box = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(corner);
    for (const points of [rect(upright), box]) {
      draw.filter = 'blur(3px)';
      fill('rgb(0 0 0 / .12)', points, 4);
      draw.filter = 'blur(0.7px)';
      fill('#3b2f2a', points);
    }
    draw.filter = 'none';
    const light = draw.createLinearGradient(0, 0, 1000, 700);
    light.addColorStop(0, 'rgb(255 244 220 / .16)');
    light.addColorStop(1, 'rgb(0 10 30 / .2)');
    draw.fillStyle = light;
    draw.fillRect(0, 0, 1000, 700);
    const image = draw.getImageData(0, 0, 1000, 700);
    let seed = 7;
    for (let i = 0; i < image.data.length; i += 1) {
      seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
      if (i % 4 < 3) image.data[i] += Math.round((seed / 2 ** 32 - 0.5) * 12);
    }
    draw.putImageData(image, 0, 0);
    draw.filter = `blur(${all}px)`;
    if (all) draw.drawImage(canvas, 0, 0);
    const blob = await new Promise((done) => { canvas.toBlob(done, 'image/jpeg', 0.93); });
    return [...new Uint8Array(await blob.arrayBuffer())];
  }, [TURNED, blur]);
  return Buffer.from(bytes);
}

/** 2.0 × 1.6 m of floor between four tags, with a box, and a tag on the robot and on the goal. */
export const TAGGED = { arena: [2.0, 1.6], box: [0.9, 0.5, 1.2, 1.1], robot: [0.4, 0.8], goal: [1.6, 0.8] };

export async function taggedPhoto(page) {
  const bytes = await page.evaluate(async ({ arena: [w, h], box: [x0, y0, x1, y1], robot, goal }) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [1000, 840];
    const draw = canvas.getContext('2d');
    const at = ([x, y]) => [100 + x * 400, 100 + (h - y) * 400];
    const fill = (colour, x, y, width, height) => { draw.fillStyle = colour; draw.fillRect(x, y, width, height); };
    fill('#d8d4cc', 0, 0, 1000, 840);
    const [left, top] = at([x0, y1]);
    fill('#2a3440', left, top, (x1 - x0) * 400, (y1 - y0) * 400);
    // ArUco 4X4_50, rows from the top, white cells as ones.
    const codes = { 0: 0xb532, 1: 0x0f9a, 2: 0x332d, 3: 0x9946, 7: 0xc4f2, 5: 0x79cd };
    const tag = (id, [x, y], side) => {
      const cell = side / 6;
      fill('#f4f2ee', x - cell, y - cell, side + 2 * cell, side + 2 * cell);
      fill('#111', x, y, side, side);
      for (let i = 0; i < 16; i += 1) {
        if ((codes[id] >> (15 - i)) & 1) fill('#f4f2ee', x + (1 + (i % 4)) * cell, y + (1 + Math.floor(i / 4)) * cell, cell, cell);
      }
    };
    const side = 60;
    const corners = [[0, 0], [w, 0], [w, h], [0, h]].map(at);
    corners.forEach(([x, y], id) => tag(id, [x - ([1, 2].includes(id) ? side : 0), y - ([0, 1].includes(id) ? side : 0)], side));
    for (const [id, place] of [[7, robot], [5, goal]]) {
      const [x, y] = at(place);
      tag(id, [x - 24, y - 24], 48);
    }
    const blob = await new Promise((done) => { canvas.toBlob(done, 'image/png'); });
    return [...new Uint8Array(await blob.arrayBuffer())];
  }, TAGGED);
  return Buffer.from(bytes);
}

/** A picture of so many pixels, of one colour all over. */
export async function plainPhoto(page, [width, height], colour = '#bbb') {
  const text = await page.evaluate(async ([w, h, grey]) => {
    const canvas = new OffscreenCanvas(w, h);
    const draw = canvas.getContext('2d');
    draw.fillStyle = grey;
    draw.fillRect(0, 0, w, h);
    const blob = await canvas.convertToBlob({ type: 'image/jpeg' });
    const reader = new FileReader();
    await new Promise((done) => { reader.onload = done; reader.readAsDataURL(blob); });
    return reader.result.split(',')[1];
  }, [width, height, colour]);
  return Buffer.from(text, 'base64');
}
