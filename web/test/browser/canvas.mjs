// What is on the page's canvases, by their pixels.

/** Ranges of red, green, blue, and the least opacity. */
export const AMBER = { r: [225, 255], g: [140, 205], b: [0, 80], a: 250 };
/** What a craft is painted with, its shade included. */
export const PAINT = { r: [90, 255], g: [90, 255], b: [110, 255], a: 254 };
export const FIRE = { r: [235, 255], g: [120, 255], b: [20, 235], a: 90 };

/** How many pixels of a canvas (`front` or `back`) have such a colour. */
export async function count(page, canvas, colour) {
  return (await columns(page, canvas, colour)).count;
}

/** How many there are, and into how many groups of columns they fall, gaps of a tenth of the width apart. */
export function columns(page, canvas, colour) {
  return page.evaluate(
    ([name, { r, g, b, a }]) => {
      const node = document.querySelector(`canvas.${name}`);
      const { width, height } = node;
      const { data } = node.getContext('2d').getImageData(0, 0, width, height);
      const within = (value, [least, most]) => value >= least && value <= most;
      const found = new Array(width).fill(0);
      for (let i = 0; i < data.length; i += 4) {
        if (within(data[i], r) && within(data[i + 1], g) && within(data[i + 2], b) && data[i + 3] >= a)
          found[(i / 4) % width] += 1;
      }
      let [groups, last] = [0, -Infinity];
      found.forEach((pixels, x) => {
        if (pixels < 2) return;
        if (x - last > width / 10) groups += 1;
        last = x;
      });
      return { count: found.reduce((sum, pixels) => sum + pixels, 0), groups };
    },
    [canvas, colour],
  );
}

/** The middle of the craft's paint: opaque and bluish white, which nothing else that moves is. */
export function craft(page) {
  return page.evaluate(() => {
    const node = document.querySelector('canvas.front');
    const { width, height } = node;
    const { data } = node.getContext('2d').getImageData(0, 0, width, height);
    let [x, y, pixels] = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) {
      const [r, g, b, a] = [data[i], data[i + 1], data[i + 2], data[i + 3]];
      if (a < 254 || r < 150 || b < r || g < r - 6) continue;
      x += (i / 4) % width;
      y += Math.floor(i / 4 / width);
      pixels += 1;
    }
    return { x: x / pixels, y: y / pixels, pixels };
  });
}

/** The middle of what has such a colour. */
export function middle(page, canvas, colour) {
  return page.evaluate(
    ([name, { r, g, b, a }]) => {
      const node = document.querySelector(`canvas.${name}`);
      const { width, height } = node;
      const { data } = node.getContext('2d').getImageData(0, 0, width, height);
      const within = (value, [least, most]) => value >= least && value <= most;
      let [x, y, pixels] = [0, 0, 0];
      for (let i = 0; i < data.length; i += 4) {
        if (!within(data[i], r) || !within(data[i + 1], g) || !within(data[i + 2], b) || data[i + 3] < a) continue;
        x += (i / 4) % width;
        y += Math.floor(i / 4 / width);
        pixels += 1;
      }
      return { x: x / pixels, y: y / pixels, pixels };
    },
    [canvas, colour],
  );
}

/** The middle of a disc of this colour and at least this radius: where the colour lies in all eight directions. Words and
 * what is narrower, such as the links of an arm, have none. */
export function disc(page, canvas, colour, radius) {
  return page.evaluate(
    ([name, { r, g, b, a }, radius]) => {
      const node = document.querySelector(`canvas.${name}`);
      const { width, height } = node;
      const { data } = node.getContext('2d').getImageData(0, 0, width, height);
      const within = (value, [least, most]) => value >= least && value <= most;
      const isPaint = (x, y) => {
        const i = 4 * (Math.round(y) * width + Math.round(x));
        return within(data[i], r) && within(data[i + 1], g) && within(data[i + 2], b) && data[i + 3] >= a;
      };
      const around = [...Array(8).keys()].map((i) => (i * Math.PI) / 4);
      const near = around.map((angle) => [radius * Math.cos(angle), radius * Math.sin(angle)]);
      let [sx, sy, pixels] = [0, 0, 0];
      for (let y = Math.ceil(radius); y < height - radius; y += 2)
        for (let x = Math.ceil(radius); x < width - radius; x += 2) {
          if (!isPaint(x, y) || !near.every(([dx, dy]) => isPaint(x + dx, y + dy))) continue;
          [sx, sy, pixels] = [sx + x, sy + y, pixels + 1];
        }
      return { x: sx / pixels, y: sy / pixels, pixels };
    },
    [canvas, colour, radius],
  );
}
