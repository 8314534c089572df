'use strict';
// Small drawings in SVG: axes with round ticks, lines, scatter plots and a matrix of them.

/// Colours that colour-blind readers can distinguish (Okabe and Ito 2008), darkened where they are too pale on white.
const palette = ['#0072b2', '#d55e00', '#008a63', '#b35a8c', '#7a5c00', '#3d8fc4', '#444444'];
const dashes = ['', '7 3', '2 3', '9 3 2 3', '12 4', '4 2', '1 2'];

/// Sequential colours that rise in lightness (after cividis, Nuñez et al. 2018); t in [0, 1].
function sequential(t) {
  const stops = [[0, 34, 78], [61, 77, 107], [113, 117, 120], [166, 157, 101], [222, 200, 60]];
  const x = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2);
  const mix = stops[i].map((a, k) => Math.round(a + (stops[i + 1][k] - a) * (x - i)));
  return `rgb(${mix.join(',')})`;
}

function svg(tag, attributes, parent, text) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.appendChild(node);
  return node;
}

/// Round ticks within [low, high]: steps of 1, 2 or 5 times a power of ten.
function ticks(low, high, about) {
  const raw = (high - low) / about, power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = power * [1, 2, 5, 10].find(m => m * power >= raw * 0.999);
  const list = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) list.push(i * step);
  return { list, step };
}

function number(x, step) {
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size >= 1e7 || size < 1e-3) return x.toExponential(2).replace(/\.?0+e/, 'e').replace('e+', 'e');
  const decimals = step ? Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) : Math.max(0, 3 - Math.floor(Math.log10(size)));
  let s = x.toFixed(Math.min(decimals, 10));
  if (!step && s.includes('.')) s = s.replace(/\.?0+$/, '');
  return s.replace('-', '\u2212');
}

/// Range of the values with a little room; a single value gets room of its own size.
function span(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) if (v !== null && isFinite(v)) { low = Math.min(low, v); high = Math.max(high, v); }
  if (low > high) return [0, 1];
  const room = high > low ? 0.05 * (high - low) : Math.abs(low) * 0.05 || 1;
  return [low - room, high + room];
}

/// Frame, grid, ticks and axis labels; returns the two scales. `box` is {left, top, width, height} of the frame.
function axes(root, box, x, y) {
  const sx = v => box.left + box.width * (v - x.span[0]) / (x.span[1] - x.span[0]);
  const sy = v => box.top + box.height * (1 - (v - y.span[0]) / (y.span[1] - y.span[0]));
  const xt = ticks(x.span[0], x.span[1], x.about || 7), yt = y.log ? log_ticks(y.span[0], y.span[1]) : ticks(y.span[0], y.span[1], y.about || 6);
  for (const v of xt.list) {
    svg('line', { class: 'grid', x1: sx(v), x2: sx(v), y1: box.top, y2: box.top + box.height }, root);
    if (x.labels !== false) svg('text', { x: sx(v), y: box.top + box.height + 17, 'text-anchor': 'middle' }, root, x.text ? x.text(v) : number(v, xt.step));
  }
  for (const v of yt.list) {
    svg('line', { class: 'grid', y1: sy(v), y2: sy(v), x1: box.left, x2: box.left + box.width }, root);
    if (y.labels !== false) svg('text', { x: box.left - 7, y: sy(v) + 4, 'text-anchor': 'end' }, root, y.log ? log_text(v, yt.decades) : number(v, yt.step));
  }
  svg('rect', { class: 'frame', x: box.left, y: box.top, width: box.width, height: box.height }, root);
  if (x.label) svg('text', { x: box.left + box.width / 2, y: box.top + box.height + 37, 'text-anchor': 'middle' }, root, x.label);
  if (y.label) {
    const at = `translate(${y.label_at === undefined ? box.left - 58 : y.label_at},${box.top + box.height / 2}) rotate(-90)`;
    svg('text', { transform: at, 'text-anchor': 'middle' }, root, y.label);
  }
  return { sx, sy };
}

/// Exponents of the ticks of a logarithmic axis: 1, 2, 5 times powers of ten over few decades, else the powers alone.
function log_ticks(low, high) {
  const list = [], decades = high - low > 3;
  for (let n = Math.floor(low); n <= high; ++n)
    for (const m of decades ? [1] : [1, 2, 5]) if (n + Math.log10(m) >= low && n + Math.log10(m) <= high) list.push(n + Math.log10(m));
  return { list, decades };
}

function log_text(v, decades) {
  return decades ? power_of_ten(v) : number(Number(Math.pow(10, v).toPrecision(1)));
}

function power_of_ten(v) {
  const digits = { '-': '\u207b', 0: '\u2070', 1: '\u00b9', 2: '\u00b2', 3: '\u00b3', 4: '\u2074', 5: '\u2075', 6: '\u2076', 7: '\u2077', 8: '\u2078', 9: '\u2079' };
  return '10' + String(Math.round(v)).split('').map(c => digits[c]).join('');
}

/// Lines {label, x, y} with a legend below, shaded between `low` and `high` where they have them; `log` draws log10 of y.
function draw_lines(place, data, log) {
  if (!place || !data) return;
  const longest = Math.max(...data.lines.map(l => l.label.length));
  const height = 340, columns = Math.max(1, Math.min(data.lines.length, Math.floor(710 / (64 + 7.6 * longest)))), rows = Math.ceil(data.lines.length / columns);
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 800 ${height + 62 + 20 * rows}` }, place);
  const shown = data.lines.map(l => ({ label: l.label, group: l.group, variant: l.variant, x: l.x, y: log ? l.y.map(v => v > 0 ? Math.log10(v) : null) : l.y }));
  const box = { left: 78, top: 10, width: 710, height };
  const ys = span(data.span || shown.flatMap(l => l.y)), xs = span(shown.flatMap(l => l.x));
  const scale = axes(root, box, { span: [Math.max(xs[0], 0), xs[1]], label: data.x_label }, { span: ys, label: data.y_label, log });
  const clip = `${place.id}-clip`;
  svg('rect', { x: box.left, y: box.top, width: box.width, height: box.height }, svg('clipPath', { id: clip }, svg('defs', {}, root)));
  data.lines.forEach(line => {
    if (!line.low) return;
    const edge = (ys, list) => list.map(k => `${scale.sx(line.x[k]).toFixed(1)},${scale.sy(ys[k]).toFixed(1)}`);
    const order = line.x.map((_, k) => k);
    const points = edge(line.high, order).concat(edge(line.low, order.slice().reverse())).join(' ');
    svg('polygon', { points, fill: palette[line.group % palette.length], opacity: 0.13, 'clip-path': `url(#${clip})` }, root);
  });
  shown.forEach((line, i) => {
    let path = '', pen = 'M';
    line.x.forEach((x, k) => {
      if (line.y[k] === null) { pen = 'M'; return; }
      path += `${pen}${scale.sx(x).toFixed(1)},${scale.sy(line.y[k]).toFixed(1)}`;
      pen = 'L';
    });
    const style = { fill: 'none', stroke: palette[line.group % palette.length], 'stroke-width': 2, 'stroke-dasharray': dashes[line.variant % dashes.length] };
    svg('title', {}, svg('path', Object.assign({ d: path, 'clip-path': `url(#${clip})` }, style), root), line.label);
    const lx = box.left + (i % columns) * (box.width / columns), ly = height + 68 + 20 * Math.floor(i / columns);
    svg('line', Object.assign({ x1: lx, x2: lx + 34, y1: ly - 4, y2: ly - 4 }, style), root);
    svg('text', { x: lx + 42, y: ly }, root, line.label);
  });
}

/// Best (density, sound speed) of each round, coloured by objective, and the line of constant product.
function draw_ridge(place, data) {
  if (!place || !data) return;
  const root = svg('svg', { class: 'drawing', viewBox: '0 0 800 462' }, place);
  const box = { left: 78, top: 10, width: 600, height: 380 };
  const xs = span(data.points.map(p => p[0]).concat(data.marks.map(m => m.x)));
  const ys = span(data.points.map(p => p[1]).concat(data.marks.map(m => m.y)));
  const scale = axes(root, box, { span: xs, label: data.x_label }, { span: ys, label: data.y_label });
  const clip = svg('clipPath', { id: 'ridge-clip' }, svg('defs', {}, root));
  svg('rect', { x: box.left, y: box.top, width: box.width, height: box.height }, clip);
  if (data.product) {
    let path = '';
    for (let i = 0; i <= 120; ++i) {
      const x = xs[0] + (xs[1] - xs[0]) * i / 120;
      if (x > 0) path += `${path ? 'L' : 'M'}${scale.sx(x).toFixed(1)},${scale.sy(data.product / x).toFixed(1)}`;
    }
    svg('path', { d: path, fill: 'none', stroke: '#444', 'stroke-width': 1.5, 'stroke-dasharray': '6 4', 'clip-path': 'url(#ridge-clip)' }, root);
  }
  // The colours span from the 5 % quantile to the best value, since one bad round would take the whole scale otherwise.
  const sorted = data.points.map(p => p[2]).sort((a, b) => a - b);
  const quantile = q => sorted[Math.round(q * (sorted.length - 1))];
  const low = data.minimise ? quantile(0) : quantile(0.05), high = data.minimise ? quantile(0.95) : quantile(1);
  const shade = v => sequential(high > low ? (v - low) / (high - low) : 1);
  for (const [x, y, v, optimizer] of data.points) {
    const dot = svg('circle', { cx: scale.sx(x), cy: scale.sy(y), r: 5, fill: shade(v), 'fill-opacity': 0.85, stroke: '#333', 'stroke-width': 0.6 }, root);
    svg('title', {}, dot, `${optimizer}: ${number(v)} at ${number(x)}, ${number(y)}`);
  }
  const taken = [];  // places of the labels, to keep the labels of close marks apart
  data.marks.forEach((m, i) => {
    const cx = scale.sx(m.x), cy = scale.sy(m.y), colour = (series_style[m.label.toLowerCase()] || { color: palette[i % palette.length] }).color;
    svg('path', { d: `M${cx - 9},${cy}H${cx + 9}M${cx},${cy - 9}V${cy + 9}`, stroke: '#fff', 'stroke-width': 5 }, root);
    svg('path', { d: `M${cx - 9},${cy}H${cx + 9}M${cx},${cy - 9}V${cy + 9}`, stroke: colour, 'stroke-width': 2.6 }, root);
    const right = cx < box.left + box.width - 80;
    let ty = Math.max(cy - 9, box.top + 14);
    while (taken.some(t => Math.abs(t[0] - cx) < 90 && Math.abs(t[1] - ty) < 15)) ty += 16;
    taken.push([cx, ty]);
    const style = { x: cx + (right ? 12 : -12), y: ty, 'text-anchor': right ? 'start' : 'end', 'font-weight': 600 };
    svg('text', Object.assign({ stroke: '#fff', 'stroke-width': 4, 'stroke-linejoin': 'round' }, style), root, m.label);
    svg('text', style, root, m.label);
  });
  const bar = { left: 712, top: 30, width: 16, height: 340 };
  for (let i = 0; i < 60; ++i)
    svg('rect', { x: bar.left, y: bar.top + bar.height * (59 - i) / 60, width: bar.width, height: bar.height / 60 + 0.6, fill: sequential(i / 59) }, root);
  if (high > low) {
    const t = ticks(low, high, 5);
    for (const v of t.list) svg('text', { x: bar.left + 22, y: bar.top + bar.height * (1 - (v - low) / (high - low)) + 4 }, root, number(v, t.step));
  } else if (sorted.length) {
    svg('text', { x: bar.left + 22, y: bar.top + 8 }, root, number(high));
  }
  svg('text', { transform: `translate(788,${bar.top + bar.height / 2}) rotate(-90)`, 'text-anchor': 'middle' }, root, data.value_label);
  svg('line', { x1: 80, x2: 112, y1: 450, y2: 450, stroke: '#444', 'stroke-width': 1.5, 'stroke-dasharray': '6 4' }, root);
  svg('text', { x: 120, y: 454 }, root, '\u03c1c = const through the calibrated point');
}

/// Every pair of parameters of the design; the first six parameters at most.
function draw_design(place, data) {
  if (!place || !data) return;
  const n = Math.min(data.parameters.length, 6);
  const all = data.done.concat(data.failed);
  const spans = data.parameters.map((_, k) => span(all.map(r => r[k])));
  const cells = [];
  if (n === 1) cells.push([0, -1]);
  for (let j = 1; j < n; ++j) for (let i = 0; i < j; ++i) cells.push([i, j]);
  const columns = Math.min(cells.length, 3), width = 800 / Math.max(columns, 2), height = 250;
  const rows = Math.ceil(cells.length / columns);
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 ${width * columns} ${height * rows + 24}`, style: `max-width:${width * columns * 1.35}px` }, place);
  cells.forEach(([i, j], k) => {
    const box = { left: (k % columns) * width + 78, top: Math.floor(k / columns) * height + 8, width: width - 96, height: height - 66 };
    const scale = axes(root, box, { span: spans[i], label: data.parameters[i], about: 3 },
      j < 0 ? { span: [0, 1], labels: false } : { span: spans[j], label: data.parameters[j], about: 4, label_at: box.left - 62 });
    const y = (r, index, count) => scale.sy(j < 0 ? (index + 0.5) / count : r[j]);
    data.done.forEach((r, index) => svg('circle', { cx: scale.sx(r[i]).toFixed(1), cy: y(r, index, data.done.length).toFixed(1), r: 2.6, fill: palette[0], 'fill-opacity': 0.7 }, root));
    data.failed.forEach((r, index) => {
      const cx = scale.sx(r[i]), cy = y(r, index, data.failed.length);
      svg('path', { d: `M${cx - 4},${cy - 4}l8,8M${cx - 4},${cy + 4}l8,-8`, stroke: palette[1], 'stroke-width': 2 }, root);
    });
  });
  const ly = height * rows + 14;
  svg('circle', { cx: 84, cy: ly - 4, r: 3.4, fill: palette[0] }, root);
  svg('text', { x: 94, y: ly }, root, `completed (${data.done.length} shown)`);
  svg('path', { d: `M${256},${ly - 8}l8,8M${256},${ly}l8,-8`, stroke: palette[1], 'stroke-width': 2 }, root);
  svg('text', { x: 272, y: ly }, root, `failed (${data.failed.length})`);
}

/// A label in lines of at most `most` letters, broken at blanks and behind underscores where it can be.
function label_lines(label, most) {
  const lines = [];
  for (const part of label.split(/(?<=_)|\s+/)) {
    const last = lines[lines.length - 1], joint = last && last.endsWith('_') ? '' : ' ';
    if (last && last.length + joint.length + part.length <= most) lines[lines.length - 1] = last + joint + part;
    else lines.push(part);
  }
  return lines;
}
