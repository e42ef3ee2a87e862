// Mouse, pen and touch on the canvas.

import { fail, setSplit } from './actions.js';
import { pin, pixelUnder, readOut } from './pixel.js';
import { byId, state, viewport } from './session.js';

export function listenToCanvas(canvas) {
    let drag = null;
    const onSplit = (event) => {
        if (state.layout !== 'split') return false;
        const at = viewport.locate(event.clientX, event.clientY);
        return Math.abs(at.canvasX - viewport.split * canvas.width) < 6 * (window.devicePixelRatio || 1);
    };
    canvas.addEventListener('pointerdown', (event) => {
        canvas.setPointerCapture(event.pointerId);
        drag = { x: event.clientX, y: event.clientY, moved: false, split: onSplit(event) };
    });
    canvas.addEventListener('pointermove', (event) => {
        canvas.style.cursor = onSplit(event) || drag?.split ? 'ew-resize' : 'crosshair';
        if (!drag) {
            byId('readout').textContent = readOut(...pixelUnder(event));
            return;
        }
        const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
        if (!drag.moved && Math.hypot(dx, dy) < 4) return;
        drag.moved = true;
        const box = canvas.getBoundingClientRect();
        if (drag.split) setSplit((event.clientX - box.left) / box.width);
        else {
            viewport.pan((dx * canvas.width) / box.width, (dy * canvas.height) / box.height);
            drag.x = event.clientX;
            drag.y = event.clientY;
        }
    });
    canvas.addEventListener('pointerup', (event) => {
        if (drag && !drag.moved) pin(...pixelUnder(event), false).catch(fail);
        drag = null;
    });
    canvas.addEventListener('pointercancel', () => { drag = null; });
    canvas.addEventListener('wheel', (event) => {
        event.preventDefault();
        viewport.zoom(Math.pow(1.0015, -event.deltaY), event.clientX, event.clientY);
    }, { passive: false });
}
