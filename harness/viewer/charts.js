// A chart of series over the time of the run. A click or a drag in it chooses the time.
class Chart {
  // lines: [{values, color (a variable of style.css), label}]; a value for each step of `dt` seconds.
  constructor(canvas, lines, dt, duration, seek) {
    Object.assign(this, {canvas, lines, dt, duration, now: 0});
    let low = 0, high = 0;
    for (const line of lines) {
      for (const value of line.values) {
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    this.low = low;
    this.high = high > low ? high : low + 1;
    const choose = (event) => {
      const box = canvas.getBoundingClientRect();
      seek((event.clientX - box.left - Chart.left) / (box.width - Chart.left - Chart.right) * duration);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      choose(event);
    });
    canvas.addEventListener("pointermove", (event) => event.buttons && choose(event));
  }

  // The number of the step that has led to the present time; -1 before the first.
  get step() {
    return Math.min(Math.round(this.now / this.dt), this.lines[0].values.length) - 1;
  }

  draw() {
    const {canvas, low, high, duration} = this, ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext("2d"), colors = getComputedStyle(document.documentElement);
    const color = (name) => colors.getPropertyValue(name);
    pen.scale(ratio, ratio);
    pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const x = (time) => Chart.left + time / (duration || 1) * (width - Chart.left - Chart.right);
    const y = (value) => height - Chart.bottom - (value - low) / (high - low) * (height - Chart.bottom - Chart.top);
    pen.strokeStyle = color("--line");
    pen.fillStyle = color("--faint");
    pen.textAlign = "right";
    for (const value of Chart.ticks(low, high, Math.max(2, Math.floor(height / 40)))) {
      pen.beginPath();
      pen.moveTo(Chart.left, y(value));
      pen.lineTo(width - Chart.right, y(value));
      pen.stroke();
      pen.fillText(Chart.short(value), Chart.left - 4, y(value) + 4);
    }
    pen.textAlign = "center";
    for (const time of Chart.ticks(0, duration, 4)) pen.fillText(Chart.short(time) + " s", x(time), height - 3);
    for (const line of this.lines) {
      pen.strokeStyle = color(line.color);
      pen.lineWidth = 1.3;
      pen.beginPath();
      line.values.forEach((value, i) => pen.lineTo(x((i + 1) * this.dt), y(value)));
      pen.stroke();
    }
    pen.textAlign = "right";
    let row = Chart.top + 10;
    for (const line of this.lines.filter((l) => l.label)) {
      pen.fillStyle = color(line.color);
      pen.fillText(line.label, width - Chart.right - 4, row);
      row += 14;
    }
    pen.strokeStyle = color("--ink");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x(this.now), Chart.top);
    pen.lineTo(x(this.now), height - Chart.bottom);
    pen.stroke();
  }

  // Round numbers: at most `most` of them.
  static ticks(low, high, most) {
    const rough = (high - low) / most, power = Math.pow(10, Math.floor(Math.log10(rough || 1)));
    const step = power * [1, 2, 5, 10].find((factor) => power * factor >= rough * 0.999);
    const result = [];
    for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-9); ++k) result.push(k * step);
    return result;
  }

  static short(value) {
    const size = Math.abs(value);
    if (size >= 1e6 || (size > 0 && size < 1e-3)) return value.toExponential(0);
    return size >= 1e4 ? Number((value / 1000).toPrecision(3)) + "k" : String(Number(value.toPrecision(3)));
  }
}
Chart.left = 42;
Chart.right = 8;
Chart.top = 6;
Chart.bottom = 18;

