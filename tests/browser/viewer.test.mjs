// The viewer's pages in a real browser: what the canvas shows against the values in the files.

import assert from 'node:assert/strict';
import { once } from 'node:events';
import { copyFileSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { canvasColor, canvasColors, clickPixel, covtrace, folder, launch, open, painting, renderScene, table, writeImage } from './support.mjs';

const srgbLevel = (v) => {
    const c = Math.min(1, Math.max(0, v));
    return Math.floor(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055) + 0.5);
};
const kWidth = 40, kHeight = 24;
// All sizes that matter: black, the toe of the curve, mid greys, above white, negative.
const pattern = (x, y) => [2 ** (x / 4 - 8), (x - 10) / 20, y / 23];
const other = (x, y) => pattern(x, y).map((v, c) => v + (c === 1 && x >= 14 && x < 18 ? 0.25 : 0));

let browser;
before(async () => {
    writeImage('a.pfm', kWidth, kHeight, pattern);
    writeImage('b.pfm', kWidth, kHeight, other);
    renderScene('out.exr', '--layers', 'all,share');
    covtrace('inspect', 'a.pfm', '--report', 'a.html');
    covtrace('compare', 'a.pfm', 'b.pfm', '--report', 'ab.html');
    covtrace('inspect', 'out.exr', '--report', 'out.html');
    browser = await launch();
});
after(() => browser?.close());

test('the canvas shows every pixel as sRGB does, at any exposure', async () => {
    const page = await open(browser, 'a.html');
    for (const stops of [0, 0.5, 1]) {
        if (stops > 0) await painting(page, () => page.keyboard.press('e'));
        (await canvasColors(page, kWidth, kHeight)).forEach((shown, i) => {
            const [x, y] = [i % kWidth, Math.floor(i / kWidth)];
            assert.deepEqual(shown, pattern(x, y).map((v) => srgbLevel(Math.fround(v) * 2 ** stops)), `${x},${y} at ${stops}`);
        });
    }
    assert.deepEqual(page.problems, []);
});

test('values are lossless', async () => {
    const page = await open(browser, 'a.html');
    for (const [x, y] of [[0, 0], [7, 3], [39, 23]]) {
        await clickPixel(page, x, y);
        const shown = await table(page, 'Values');
        assert.deepEqual(['R', 'G', 'B'].map((c) => Math.fround(Number(shown[c][0]))), pattern(x, y).map(Math.fround));
    }
});

test('numbers that are not finite stand out and do no harm', async () => {
    writeImage('bad.pfm', 8, 4, (x, y) => [x === 3 ? NaN : x === 4 ? Infinity : 0.5, 0.5, 0.5]);
    covtrace('inspect', 'bad.pfm', '--report', 'bad.html');
    const page = await open(browser, 'bad.html');
    assert.deepEqual(await canvasColor(page, 3, 2), [255, 0, 255]);
    assert.deepEqual(await canvasColor(page, 4, 2), [255, 188, 188]);
    await clickPixel(page, 3, 1);
    assert.equal((await table(page, 'Values')).R[0], 'NaN');
    assert.deepEqual(page.problems, []);
});

test('split, flip and differences', async () => {
    const page = await open(browser, 'ab.html');
    const colors = (f, x, y) => f(x, y).map((v) => srgbLevel(Math.fround(v)));
    await page.fill('#split', '0');  // all of it is B
    assert.deepEqual(await canvasColor(page, 15, 8), colors(other, 15, 8));
    await page.fill('#split', '100');
    assert.deepEqual(await canvasColor(page, 15, 8), colors(pattern, 15, 8));
    await page.focus('#view');
    await painting(page, () => page.keyboard.press('f'));
    assert.deepEqual(await canvasColor(page, 15, 8), colors(pattern, 15, 8));
    await painting(page, () => page.keyboard.press('f'));
    assert.deepEqual(await canvasColor(page, 15, 8), colors(other, 15, 8));

    // |A - B| is a third of 0.25 in four columns and nothing elsewhere; grey from 0 to 1/6 puts it in the middle.
    await painting(page, () => page.keyboard.press('d'));
    await painting(page, () => page.selectOption('#scale', 'grey'));
    await page.fill('#high', String(0.25 / 3 * 2));
    await painting(page, () => page.press('#high', 'Tab'));
    const [grey] = await canvasColor(page, 15, 8);
    assert.ok(grey === 127 || grey === 128, `grey level ${grey}`);
    assert.deepEqual(await canvasColor(page, 20, 8), [0, 0, 0]);
    assert.deepEqual(page.problems, []);
});

test('the FLIP map has the mean that compare gives', async () => {
    const { flip } = JSON.parse(covtrace('compare', 'a.pfm', 'b.pfm', '--json'));
    const page = await open(browser, 'ab.html');
    await painting(page, () => page.keyboard.press('d'));
    await painting(page, () => page.selectOption('#kind', 'flip'));
    await painting(page, () => page.selectOption('#scale', 'grey'));
    const sum = (await canvasColors(page, kWidth, kHeight)).reduce((all, [grey]) => all + grey / 255, 0);
    assert.ok(flip > 0.01);
    assert.ok(Math.abs(sum / (kWidth * kHeight) - flip) < 0.5 / 255, `${sum / (kWidth * kHeight)} and ${flip}`);
});

test('of more than two images any two are compared', async () => {
    // As `viewer::write_report` writes three: the last one is the first again.
    const html = readFileSync(path.join(folder, 'ab.html'), 'utf8').replace(/(id="report">)(.*?)(<\/script>)/s, (_, before, json, behind) => {
        const report = JSON.parse(json);
        report.images.push({ ...report.images[0], name: 'third', flip: {} });
        return before + JSON.stringify(report) + behind;
    });
    writeFileSync(path.join(folder, 'abc.html'), html);
    const page = await open(browser, 'abc.html');
    await painting(page, () => page.selectOption('#image-b', { label: 'C third' }));
    await painting(page, () => page.keyboard.press('d'));
    assert.deepEqual(await page.$$eval('#kind option', (all) => all.map((o) => o.value)), ['signed', 'absolute', 'relative']);
    await painting(page, () => page.selectOption('#scale', 'grey'));
    assert.ok((await canvasColors(page, kWidth, kHeight)).every(([grey]) => grey === 0));
    await painting(page, () => page.selectOption('#image-a', { label: 'B b.pfm' }));
    assert.ok((await canvasColors(page, kWidth, kHeight)).some(([grey]) => grey > 0));
    assert.deepEqual(page.problems, []);
});

test('images side by side pan and zoom in step', async () => {
    const page = await open(browser, 'ab.html');
    await painting(page, () => page.keyboard.press('b'));
    const box = await (await page.$('#view')).boundingBox();
    await page.mouse.move(box.x + box.width * 0.2, box.y + box.height * 0.4);
    await page.mouse.wheel(0, -400);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.3, box.y + box.height * 0.5, { steps: 4 });
    await page.mouse.up();
    const differing = await page.$eval('#view', (canvas) => {
        const half = canvas.width / 2, from = 60, height = canvas.height - from;  // below the labels
        const [a, b] = [0, half].map((x) => canvas.getContext('2d').getImageData(x + 4, from, half - 8, height).data);
        let count = 0, seen = 0;
        for (let i = 0; i < a.length; i += 4) {
            count += a[i] !== b[i] || a[i + 2] !== b[i + 2];  // the images differ in green alone
            seen += a[i + 3] !== 0;
        }
        return [count, seen];
    });
    assert.equal(differing[0], 0);
    assert.ok(differing[1] > 10000);
});

test('a pixel tells what `inspect --pixel` tells', async () => {
    const [x, y] = [20, 18];
    const { pixel } = JSON.parse(covtrace('inspect', 'out.exr', '--pixel', `${x},${y}`, '--json'));
    const page = await open(browser, 'out.html');
    await clickPixel(page, x, y);
    const bandwidth = await table(page, 'How fast the light varies');
    assert.deepEqual(Object.keys(bandwidth), pixel.bandwidth.map((b) => b.axis));
    for (const b of pixel.bandwidth) {
        const [value, unit] = bandwidth[b.axis][0].split(' ');
        assert.equal(unit, b.unit);
        assert.ok(Math.abs(Number(value) - b.value) <= 5e-4 * b.value, `${value} and ${b.value}`);
        assert.equal(bandwidth[b.axis][1], b.words);
    }
    const matrix = await table(page, 'Covariance of the spectrum');
    pixel.covariance.flat().forEach((v, k) => {
        const shown = Number(Object.values(matrix)[Math.floor(k / 5)][k % 5]);
        assert.ok(Math.abs(shown - v) <= 0.051 * Math.abs(v), `${shown} and ${v}`);
    });
    const text = await page.textContent('#pixel');
    const { major, minor, angle_degrees: angle } = pixel.filter;
    const [, a, b, degrees] = text.match(/Gaussian of (\S+) by (\S+) pixels .*? at (\S+)°/).map(Number);
    assert.ok(Math.abs(a - major) <= 1e-3 * major && Math.abs(b - minor) <= 1e-3 * minor, text);
    assert.ok(Math.abs(degrees - angle) <= 0.051, `${degrees} and ${angle}`);
    assert.ok(text.includes(`${pixel.samples} samples taken`), text);
    const shares = ['denoiser', 'regression', 'gaussian', 'raw'].map((kind) => Math.round(100 * pixel.shares[kind]));
    assert.deepEqual([...text.match(/Made of: (.*?)\./)[1].matchAll(/(\d+) %/g)].map((m) => Number(m[1])), shares);
});

test('uncertain pixels are links that zoom, with the sentence of `inspect`', async () => {
    const { most_uncertain: uncertain } = JSON.parse(covtrace('inspect', 'out.exr', '--json'));
    const page = await open(browser, 'out.html');
    const pinned = () => page.$eval('#view', (canvas) => canvas.dataset.pinned);
    for (const { x, y, sentence } of uncertain) {
        await page.click(`#facts a[href="#${x},${y}"]`);
        await page.waitForFunction((at) => document.getElementById('view').dataset.pinned === at, `${x},${y}`);
        const shown = await page.textContent('#pixel .certainty');
        assert.equal(shown.toLowerCase(), `${sentence}.`.toLowerCase());
        const { left, top, scale } = await page.$eval('#view', (canvas) => ({ ...canvas.dataset }));
        assert.ok(Number(scale) >= 16, scale);
        const middle = await page.$eval('#view', (canvas) => [canvas.width / 2, canvas.height / 2]);
        [[left, x], [top, y]].forEach(([from, at], k) => assert.ok(Math.abs(Number(from) + (at + 0.5) * scale - middle[k]) <= scale));
    }
    // A second click on the same link leads there again, and the address of a page may name a pixel
    const [{ x, y }] = uncertain.slice(-1);
    await clickPixel(page, x, y > 0 ? y - 1 : y + 1);
    await page.click(`#facts a[href="#${x},${y}"]`);
    await page.waitForFunction((at) => document.getElementById('view').dataset.pinned === at, `${x},${y}`);
    const direct = await open(browser, 'out.html', true, '#3,5');
    await direct.waitForFunction(() => document.getElementById('view').dataset.pinned === '3,5');
    assert.equal(await pinned(), `${x},${y}`);
    assert.deepEqual([...page.problems, ...direct.problems], []);
});

test('the filter is drawn as an ellipse of its size', async () => {
    const [x, y] = [24, 16];  // on the ball, grey enough for the marks to stand out
    const { pixel } = JSON.parse(covtrace('inspect', 'out.exr', '--pixel', `${x},${y}`, '--json'));
    const page = await open(browser, 'out.html');
    await clickPixel(page, x, y);
    // Along the longer axis the inner ring is crossed one standard deviation from the pixel's middle.
    const rings = await page.$eval('#view', (canvas, [px, py, major, degrees]) => {
        const { left, top, scale } = canvas.dataset;
        const [c, s] = [Math.cos((degrees * Math.PI) / 180), -Math.sin((degrees * Math.PI) / 180)];
        const isMark = ([r, g, b]) => r > 140 && g > 0.7 * r && b < 0.6 * r;
        const found = [];
        for (let d = 0; d < 2.5 * major * scale; d += 0.5) {
            const at = [Number(left) + (px + 0.5) * scale + c * d, Number(top) + (py + 0.5) * scale + s * d];
            if (isMark(canvas.getContext('2d').getImageData(...at.map(Math.floor), 1, 1).data)) found.push(d / scale);
        }
        return found;
    }, [x, y, pixel.filter.major, pixel.filter.angle_degrees]);
    const { scale } = await page.$eval('#view', (canvas) => ({ ...canvas.dataset }));
    for (const deviations of [1, 2])
        assert.ok(rings.some((d) => Math.abs(d - deviations * pixel.filter.major) < 2 / scale), `${rings}, ${pixel.filter.major}`);
});

test('every layer and every way to show it is painted', async () => {
    const page = await open(browser, 'out.html');
    const layers = await page.$$eval('#layer option', (all) => all.map((o) => o.value));
    for (const name of ['', 'raw', 'albedo', 'N', 'Z', 'variance', 'error', 'samples', 'density', 'filter', 'spectrum', 'cov'])
        assert.ok(layers.includes(name), name);
    for (const layer of layers) {
        if (layer !== '') await painting(page, () => page.selectOption('#layer', layer));
        const ways = await page.$$eval('#component option', (all) => all.map((o) => o.value));
        for (const way of ways) await page.selectOption('#component', way);
        await page.waitForTimeout(50);
    }
    assert.deepEqual(page.problems, []);
    assert.equal(await page.isVisible('#failure'), false);
});

test('the keyboard reaches everything, and everything has a name', async () => {
    const page = await open(browser, 'ab.html');
    const reached = new Set();
    for (let i = 0; i < 60; ++i) {
        await page.keyboard.press('Tab');
        reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.value || document.activeElement.tagName));
    }
    for (const id of ['help-button', 'layer', 'component', 'exposure', 'split', 'zoom-in', 'view', 'pixel-x', 'pixel-y'])
        assert.ok(reached.has(id), `${id} of ${[...reached]}`);
    const nameless = await page.$$eval('button, input, select, canvas, output, dialog, fieldset', (all) => all.filter((e) =>
        !(e.labels?.length || e.getAttribute('aria-label') || e.getAttribute('aria-labelledby') || e.textContent.trim())).map((e) => e.outerHTML));
    assert.deepEqual(nameless, []);
    await page.focus('#view');
    await page.keyboard.press('ArrowRight');
    await page.waitForSelector(`#view[data-pinned="${kWidth / 2 + 1},${kHeight / 2}"]`);
    await page.keyboard.press('Shift+ArrowUp');
    await page.waitForSelector(`#view[data-pinned="${kWidth / 2 + 1},${kHeight / 2 - 10}"]`);
    await page.keyboard.press('?');
    assert.ok(await page.isVisible('#help'));
    await page.keyboard.press('Escape');
    assert.equal(await page.isVisible('#help'), false);
    assert.deepEqual(page.problems, []);
});

test('hostile names and metadata stay text', async () => {
    const name = `<img src=x onerror="hacked=1">'"&amp;</script><script>hacked=2<!--.exr`.replace(/[/]/g, '\u2044');
    const plain = `<img src=x onerror=hacked=3>.exr`;
    copyFileSync(path.join(folder, 'out.exr'), path.join(folder, name));
    // The command goes into the metadata.
    renderScene(plain, '--spp', '1', '--method', 'uniform', '--stats', '<\u2044script><svg onload=hacked=4>.json');
    covtrace('compare', name, plain, '--report', 'hostile.html');
    const html = readFileSync(path.join(folder, 'hostile.html'), 'utf8');
    assert.equal(html.includes('onerror="hacked'), false);
    assert.equal(html.includes('<svg'), false);
    const page = await open(browser, 'hostile.html');
    await page.click('summary >> nth=1');
    await clickPixel(page, 3, 3);
    assert.equal(await page.evaluate(() => typeof hacked), 'undefined');
    assert.equal(await page.$$eval('img, svg, iframe', (all) => all.length), 0);
    assert.ok((await page.title()).startsWith(name));
    assert.ok((await page.textContent('#facts')).includes('<svg onload=hacked=4>'));
    assert.deepEqual(page.problems, []);
});

test('the policy of the page stops foreign scripts, styles and requests', async () => {
    const page = await open(browser, 'a.html');
    await page.evaluate(() => {
        const script = document.createElement('script');
        script.textContent = 'window.hacked = 1';
        document.body.append(script);
        const image = document.createElement('img');
        image.src = 'https://example.org/x.png';
        document.body.append(image);
        setTimeout(() => { throw new Error('thrown here'); });
    });
    assert.equal(await page.evaluate(() => window.hacked), undefined);
    assert.equal(await page.evaluate(() => fetch('https://example.org/').then(() => 'fetched', () => 'refused')), 'refused');
    for (const problem of ['violates the following', 'thrown here'])
        assert.ok(page.problems.some((p) => p.includes(problem)), String(page.problems));
});

test('a page asks for nothing but itself', async () => {
    // Firefox' protocol doesn't tell of what pages of files ask for; its own list does.
    const asked = async (page, file) => [...new Set([...page.requests, ...await page.evaluate(() => performance.getEntriesByType('resource').map((e) => e.name))])]
        .filter((url) => url !== pathToFileURL(path.join(folder, file)).href);
    for (const file of ['a.html', 'ab.html', 'out.html']) {
        const page = await open(browser, file);
        await clickPixel(page, 3, 3);
        assert.deepEqual(await asked(page, file), []);
    }
    // A page that asks, which its policy would forbid, is seen to.
    const server = createServer((_, response) => response.end()).listen(0, '127.0.0.1');
    await once(server, 'listening');
    const url = `http://127.0.0.1:${server.address().port}/x.css`;
    const html = readFileSync(path.join(folder, 'a.html'), 'utf8');
    writeFileSync(path.join(folder, 'asks.html'), html.replace(/<meta http-equiv[^>]*>/, `<link rel="stylesheet" href="${url}">`));
    const page = await open(browser, 'asks.html', false);
    server.close();
    assert.deepEqual(await asked(page, 'asks.html'), [url]);
});
