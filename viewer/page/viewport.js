// The canvas: panes that show pictures of the same size with one pan and zoom, a split line, and marks.

const kMostZoom = 128;  // screen pixels per image pixel
const kCloseZoom = 16;  // the same where one pixel is looked at

export class Viewport {
    /** Makes a viewport. canvas: the element; size: [width, height] of the images in pixels. */
    constructor(canvas, [width, height]) {
        this.canvas = canvas;
        this.context = canvas.getContext('2d', { willReadFrequently: true });
        this.width = width;
        this.height = height;
        this.scale = 1;       // canvas pixels per image pixel
        this.center = [width / 2, height / 2];  // the image point in the middle of each pane
        this.split = 0.5;     // place of the split line, as a share of the canvas' width
        this.panes = [];      // { picture, label, from, to }: shares of the width that a picture is seen in
        this.shared = true;   // panes lie over one another (split) instead of side by side
        this.marks = null;    // { x, y, ellipse }
        this.fitted = true;
    }

    /** Shows pictures, canvases with labels. 'side': one beside the other; 'split': two, cut at this.split. */
    setPanes(pictures, layout) {
        this.layout = layout;
        this.shared = layout !== 'side';
        this.pictures = pictures;
        this.draw();
    }

    layOut() {
        const n = this.pictures.length;
        return this.pictures.map((p, k) => {
            if (n === 1) return { ...p, from: 0, to: 1 };
            if (this.shared) return { ...p, from: k === 0 ? 0 : this.split, to: k === 0 ? this.split : 1 };
            return { ...p, from: k / n, to: (k + 1) / n };
        });
    }

    resize() {
        const ratio = window.devicePixelRatio || 1;
        const box = this.canvas.getBoundingClientRect();
        this.canvas.width = Math.max(1, Math.round(box.width * ratio));
        this.canvas.height = Math.max(1, Math.round(box.height * ratio));
        if (this.fitted) this.fit();
        else this.draw();
    }

    paneWidth() {
        return this.canvas.width / (this.shared || !this.pictures ? 1 : this.pictures.length);
    }

    fit() {
        this.scale = Math.min(this.paneWidth() / this.width, this.canvas.height / this.height) * 0.98;
        if (this.scale > 1) this.scale = Math.floor(this.scale);
        this.center = [this.width / 2, this.height / 2];
        this.fitted = true;
        this.draw();
    }

    /** Screen position (CSS pixels within the canvas) of the middle of a pane, and the image point under a position. */
    locate(clientX, clientY) {
        const box = this.canvas.getBoundingClientRect();
        const x = ((clientX - box.left) * this.canvas.width) / box.width;
        const y = ((clientY - box.top) * this.canvas.height) / box.height;
        const pane = this.shared ? 0 : Math.min(this.pictures.length - 1, Math.floor(x / this.paneWidth()));
        const [left, top] = this.origin(pane);
        return { x: (x - left) / this.scale, y: (y - top) / this.scale, canvasX: x, canvasY: y };
    }

    /** Position of the image's corner on the canvas in a pane: on whole pixels, so that 1:1 is exact. */
    origin(pane) {
        const left = (this.shared ? 0 : pane * this.paneWidth()) + this.paneWidth() / 2 - this.center[0] * this.scale;
        const top = this.canvas.height / 2 - this.center[1] * this.scale;
        return [Math.round(left), Math.round(top)];
    }

    /** Keeps the image point under (clientX, clientY), or without one the chosen pixel or else the middle, where it is. */
    zoom(factor, clientX, clientY) {
        const least = Math.min(1, (0.25 * Math.min(this.canvas.width, this.canvas.height)) / Math.max(this.width, this.height));
        const next = Math.min(kMostZoom, Math.max(least, this.scale * factor));
        const at = clientX !== undefined ? this.locate(clientX, clientY) : this.marks && { x: this.marks.x + 0.5, y: this.marks.y + 0.5 };
        if (at) {
            const keep = 1 - this.scale / next;
            this.center[0] += (at.x - this.center[0]) * keep;
            this.center[1] += (at.y - this.center[1]) * keep;
        }
        this.scale = next;
        this.fitted = false;
        this.draw();
    }

    actualSize() {
        this.scale = 1;
        this.fitted = false;
        this.draw();
    }

    pan(dx, dy) {
        this.center[0] = Math.min(this.width, Math.max(0, this.center[0] - dx / this.scale));
        this.center[1] = Math.min(this.height, Math.max(0, this.center[1] - dy / this.scale));
        this.fitted = false;
        this.draw();
    }

    /** Brings a pixel into sight. */
    reveal(x, y) {
        const halfWidth = this.paneWidth() / 2 / this.scale, halfHeight = this.canvas.height / 2 / this.scale;
        if (Math.abs(x - this.center[0]) < halfWidth && Math.abs(y - this.center[1]) < halfHeight) return;
        this.center = [x + 0.5, y + 0.5];
        this.fitted = false;
    }

    /** Shows a pixel in the middle of the panes, large enough to tell it from those around it. */
    focus(x, y) {
        this.scale = Math.max(this.scale, kCloseZoom);
        this.center = [x + 0.5, y + 0.5];
        this.fitted = false;
        this.draw();
    }

    draw() {
        if (!this.pictures) return;
        const c = this.context;
        c.setTransform(1, 0, 0, 1, 0, 0);
        c.clearRect(0, 0, this.canvas.width, this.canvas.height);
        c.imageSmoothingEnabled = this.scale < 1;
        this.layOut().forEach((pane, k) => this.drawPane(pane, k));
        // Place of the first pane's image on the canvas, for tests and scripts.
        const [left, top] = this.origin(0);
        Object.assign(this.canvas.dataset, { left, top, scale: this.scale });
    }

    drawPane(pane, k) {
        const c = this.context;
        const from = Math.round(pane.from * this.canvas.width), to = Math.round(pane.to * this.canvas.width);
        const [left, top] = this.origin(k);
        c.save();
        c.beginPath();
        c.rect(from, 0, to - from, this.canvas.height);
        c.clip();
        c.drawImage(pane.picture, left, top, this.width * this.scale, this.height * this.scale);
        if (this.marks) this.drawMarks(left, top);
        c.restore();
        this.drawLabel(pane.label, k > 0 && this.shared ? 'right' : 'left', k > 0 && this.shared ? to : from);
        if (k > 0) {
            c.fillStyle = '#fff';
            c.fillRect(from - 1, 0, 2, this.canvas.height);
        }
    }

    drawLabel(text, align, edge) {
        const c = this.context, ratio = window.devicePixelRatio || 1;
        c.font = `${12 * ratio}px system-ui, sans-serif`;
        const width = c.measureText(text).width + 16 * ratio;
        const x = align === 'left' ? edge + 8 * ratio : edge - width - 8 * ratio;
        c.fillStyle = 'rgba(12, 13, 15, 0.78)';
        c.beginPath();
        c.roundRect(x, 8 * ratio, width, 22 * ratio, 4 * ratio);
        c.fill();
        c.fillStyle = '#f2f3f5';
        c.textBaseline = 'middle';
        c.fillText(text, x + 8 * ratio, 19.5 * ratio);
    }

    /** The pinned pixel and its filter: the ellipses of one and two standard deviations. */
    drawMarks(left, top) {
        const c = this.context, ratio = window.devicePixelRatio || 1;
        const { x, y, ellipse } = this.marks;
        const cx = left + (x + 0.5) * this.scale, cy = top + (y + 0.5) * this.scale;
        const stroke = (path, width) => {
            for (const [color, extra] of [['rgba(0, 0, 0, 0.7)', 2], ['#ffd34d', 0]]) {
                c.strokeStyle = color;
                c.lineWidth = (width + extra) * ratio;
                c.beginPath();
                path();
                c.stroke();
            }
        };
        const half = Math.max(this.scale / 2, 3 * ratio);
        stroke(() => c.rect(cx - half, cy - half, 2 * half, 2 * half), 1);
        if (!ellipse) return;
        for (const [deviations, width] of [[1, 2], [2, 1]])
            stroke(() => c.ellipse(cx, cy, Math.max(0.5, deviations * ellipse.major * this.scale),
                Math.max(0.5, deviations * ellipse.minor * this.scale), (-ellipse.angle * Math.PI) / 180, 0, 2 * Math.PI), width);
    }
}
