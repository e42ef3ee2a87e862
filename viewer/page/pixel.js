// The pixel under the cursor and the chosen one.

import { formatExactly, formatNumber } from './format.js';
import { filterOf, showPixel } from './inspector.js';
import { findLayer } from './layers.js';
import { byId, componentOf, flipPlane, imageA, imageB, planes, report, several, state, viewport } from './session.js';

const indexOf = (x, y) => (y - report.y0) * report.width + (x - report.x0);
const inside = (x, y) => x >= report.x0 && y >= report.y0 && x < report.x0 + report.width && y < report.y0 + report.height;

export function pixelUnder(event) {
    const at = viewport.locate(event.clientX, event.clientY);
    return [Math.floor(at.x) + report.x0, Math.floor(at.y) + report.y0];
}

export function readOut(x, y) {
    if (!inside(x, y)) return '';
    const parts = [`${x}, ${y}`];
    for (const image of several ? [imageA(), imageB()] : [imageA()]) {
        const layer = findLayer(image, state.layer);
        const component = componentOf(image);
        if (!layer || !component) continue;
        const channels = component.kind === 'scalar' && layer.channels.length > 4
            ? layer.channels.filter((c) => component.planes.includes(c.plane)) : layer.channels.slice(0, 4);
        const values = channels.map((c) => {
            const plane = planes.get(c.plane);
            return plane ? `${c.name} ${formatExactly(plane[indexOf(x, y)])}` : '';
        });
        parts.push(`${several ? image.short + ':  ' : ''}${values.join('  ')}`);
    }
    if (state.layout === 'difference' && state.kind === 'flip') parts.push(`FLIP ${formatNumber(planes.get(flipPlane())[indexOf(x, y)])}`);
    return parts.join('     ');
}

/** Chooses a pixel: marks it, draws its filter and fills the panel. */
export async function pin(x, y, reveal) {
    if (!inside(x, y)) return;
    state.pixel = [x, y];
    byId('pixel-x').value = x;
    byId('pixel-y').value = y;
    byId('pixel-hint').hidden = true;
    const shown = several ? [...new Set([imageA(), imageB()])] : [imageA()];
    await planes.load(shown.flatMap((image) => image.layers.flatMap((l) => l.channels.map((c) => c.plane))));
    if (state.pixel[0] !== x || state.pixel[1] !== y) return;
    const index = indexOf(x, y);
    const filter = shown.map((image) => filterOf(planes, image, index)).find(Boolean);
    viewport.marks = { x: x - report.x0, y: y - report.y0, ellipse: filter };
    if (reveal) viewport.reveal(x - report.x0, y - report.y0);
    viewport.draw();
    showPixel(byId('pixel'), planes, shown, index, report);
    byId('readout').textContent = readOut(x, y);
    byId('view').dataset.pinned = `${x},${y}`;
}

/** Shows a pixel large, in the middle, and chooses it. */
export function zoomTo(x, y) {
    if (!inside(x, y)) return undefined;
    viewport.focus(x - report.x0, y - report.y0);
    return pin(x, y, true);
}

/** Chooses the pixel that lies (dx, dy) from the chosen one, or from the middle. */
export function movePin(dx, dy) {
    const [x, y] = state.pixel ?? [report.x0 + (report.width >> 1), report.y0 + (report.height >> 1)];
    const clampTo = (v, from, size) => Math.min(from + size - 1, Math.max(from, v));
    return pin(clampTo(x + dx, report.x0, report.width), clampTo(y + dy, report.y0, report.height), true);
}
