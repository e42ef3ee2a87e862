// What the tests of the viewer share: images with known values, the program, a browser that is offline.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { createRequire } from 'node:module';

// The packages are installed in the build folder, beside which nothing of them is looked for.
const { chromium, _bidiFirefox } = createRequire(path.join(process.env.COVTRACE_NODE_MODULES, 'anchor.js'))('playwright-core');

export const folder = mkdtempSync(path.join(tmpdir(), 'covtrace-browser-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

export function covtrace(...words) {
    return execFileSync(process.env.COVTRACE, words, { cwd: folder, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

/** A colour image as PFM; color(x, y) = [r, g, b], y from the top. */
export function writeImage(name, width, height, color) {
    const values = Buffer.alloc(12 * width * height);
    for (let y = 0; y < height; ++y)
        for (let x = 0; x < width; ++x)
            color(x, y).forEach((v, c) => values.writeFloatLE(v, 12 * ((height - 1 - y) * width + x) + 4 * c));
    writeFileSync(path.join(folder, name), Buffer.concat([Buffer.from(`PF\n${width} ${height}\n-1.0\n`), values]));
    return name;
}

/** A small scene out of focus, with all layers of the covariance method. */
export function renderScene(name, ...words) {
    writeFileSync(path.join(folder, 'scene.pbrt'), `
# </script><script>hacked = 'comment'</script>
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.2 "float focaldistance" 4
Film "rgb" "integer xresolution" 48 "integer yresolution" 32 "string filename" "film.exr"
Sampler "zsobol" "integer pixelsamples" 8
WorldBegin
LightSource "point" "point3 from" [2 3 4] "rgb I" [10 10 10]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [3 3 3]
  Translate 0 3 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .4 .3]
Shape "sphere" "float radius" 1
Shape "trianglemesh" "point3 P" [-4 -1 -4  4 -1 -4  4 -1 4  -4 -1 4] "integer indices" [0 2 1  0 3 2]
`);
    covtrace('render', 'scene.pbrt', '-o', name, '--quiet', ...words);
    return name;
}

/** Chromium by its own protocol, or Firefox as it is installed, without changes, by WebDriver BiDi. */
export async function launch() {
    if (process.env.FIREFOX) return _bidiFirefox.launch({ executablePath: process.env.FIREFOX });
    const root = process.getuid?.() === 0;  // Chromium has no sandbox for root
    return chromium.launch({ executablePath: process.env.CHROMIUM, args: root ? ['--no-sandbox'] : [] });
}

/** The page of a report, painted; `place` is what its address has behind the file. page.problems: errors; page.requests: everything that it asked for. */
export async function open(browser, file, offline = true, place = '') {
    const context = await browser.newContext({ viewport: { width: 1200, height: 700 }, offline });
    const page = await context.newPage();
    page.problems = [];
    page.requests = [];
    page.on('pageerror', (e) => page.problems.push(e.message));
    page.on('console', (m) => m.type() === 'error' && page.problems.push(m.text()));
    page.on('dialog', (d) => { page.problems.push(`dialog ${d.message()}`); d.dismiss(); });
    page.on('request', (r) => page.requests.push(r.url()));
    await page.goto(pathToFileURL(path.join(folder, file)).href + place);
    await page.waitForSelector('#view[data-painted]');
    return page;
}

/** Does something that paints anew, and waits until it has. */
export async function painting(page, action) {
    const before = await page.getAttribute('#view', 'data-painted');
    await action();
    await page.waitForFunction((old) => document.getElementById('view').dataset.painted !== old, before);
}

/** Bytes [r, g, b] that the canvas shows in the middle of every image pixel of the first pane: row by row. */
export function canvasColors(page, width, height) {
    return page.$eval('#view', (canvas, [w, h]) => {
        const { left, top, scale } = canvas.dataset;
        const bytes = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
        const at = (origin, p) => Math.floor(Number(origin) + (p + 0.5) * Number(scale));
        return Array.from({ length: w * h }, (_, i) => {
            const k = 4 * (at(top, Math.floor(i / w)) * canvas.width + at(left, i % w));
            return [bytes[k], bytes[k + 1], bytes[k + 2]];
        });
    }, [width, height]);
}

/** The same of one pixel. */
export async function canvasColor(page, x, y) {
    return (await canvasColors(page, x + 1, y + 1)).at(-1);
}

export async function clickPixel(page, x, y) {
    const place = await page.$eval('#view', (canvas, [px, py]) => {
        const box = canvas.getBoundingClientRect(), ratio = box.width / canvas.width;
        const at = (origin, p) => (Number(origin) + (p + 0.5) * Number(canvas.dataset.scale)) * ratio;
        return [box.left + at(canvas.dataset.left, px), box.top + at(canvas.dataset.top, py)];
    }, [x, y]);
    await page.mouse.click(...place);
    await page.waitForSelector(`#view[data-pinned="${x},${y}"]`);
}

/** The cells of the table whose caption begins with `caption`: { row header: [cells] }. */
export function table(page, caption) {
    return page.evaluate((begin) => {
        const found = [...document.querySelectorAll('table')].find((t) => t.caption?.textContent.startsWith(begin));
        const rows = [...(found?.tBodies[0].rows ?? [])].map((r) => [...r.cells].map((c) => c.textContent));
        return Object.fromEntries(rows.map(([name, ...cells]) => [name, cells]));
    }, caption);
}
