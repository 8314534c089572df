'use strict';
// Chains of a posterior: prior and posterior densities, traces and ranks.

/// A curve over its own span, scaled to its greatest value, as points of a plot.
function scaled_curve(curve, scale) {
  const highest = Math.max(...curve.density, 1e-300), n = curve.density.length - 1;
  return curve.density.map((v, i) => `${scale.sx(curve.span[0] + (curve.span[1] - curve.span[0]) * i / n).toFixed(1)},${scale.sy(v / highest).toFixed(1)}`);
}

/// Prior and posterior, one panel a quantity.
function draw_priors(place, data) {
  if (!place || !data) return;
  const n = data.panels.length, columns = Math.min(n, 3), width = 960 / 3, height = 210, rows = Math.ceil(n / columns);
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 ${width * columns} ${height * rows + 26}`, style: `max-width:${width * columns}px` }, place);
  data.panels.forEach((p, i) => {
    const box = { left: (i % columns) * width + 14, top: Math.floor(i / columns) * height + 8, width: width - 34, height: height - 62 };
    const wide = t => t.list.length * (14 + 7.4 * Math.max(...t.list.map(v => number(v, t.step).length))), about = [5, 4, 3, 2].find(k => wide(ticks(p.span[0], p.span[1], k)) < box.width) || 2;
    const scale = axes(root, box, { span: p.span, label: p.label, about }, { span: [0, 1.08], labels: false, about: 2 });
    for (const [curve, colour, opacity, dash] of [[p.prior, '#6e7781', 0.16, '5 3'], [p.posterior, '#0072b2', 0.3, '']]) {
      const line = scaled_curve(curve, scale), base = scale.sy(0);
      svg('polygon', { points: [`${scale.sx(curve.span[0]).toFixed(1)},${base}`, ...line, `${scale.sx(curve.span[1]).toFixed(1)},${base}`].join(' '), fill: colour, 'fill-opacity': opacity }, root);
      svg('polyline', { points: line.join(' '), fill: 'none', stroke: colour, 'stroke-width': 1.8, 'stroke-dasharray': dash }, root);
    }
  });
  const y = height * rows + 12;
  [['#6e7781', '5 3', 'before the records'], ['#0072b2', '', 'after them']].forEach(([stroke, dash, text], i) => {
    svg('line', { x1: 14 + 200 * i, x2: 48 + 200 * i, y1: y - 4, y2: y - 4, stroke, 'stroke-width': 2.2, 'stroke-dasharray': dash }, root);
    svg('text', { x: 56 + 200 * i, y }, root, text);
  });
}

/// Traces on the left, ranks by chain on the right, one row a quantity.
function draw_chains(place, data) {
  if (!place || !data) return;
  const rows = data.quantities.length, height = 150, bottom = 62;
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 960 ${rows * height + bottom}` }, place);
  const last = data.iterations[data.iterations.length - 1] || 1;
  data.quantities.forEach((q, i) => {
    const top = i * height + 26, ys = span(q.trace.flat()), bottom_row = i === rows - 1;
    const box = { left: 92, top, width: 520, height: height - 44 }, right = { left: 668, top, width: 280, height: height - 44 };
    svg('text', { x: box.left, y: top - 9, 'font-weight': 600 }, root, q.label);
    svg('text', { x: right.left, y: top - 9 }, root, `R-hat ${q.r_hat === null ? '\u2013' : q.r_hat.toFixed(3)}, ESS ${q.ess === null ? '\u2013' : q.ess}`);
    const scale = axes(root, box, { span: [0, last], labels: bottom_row, label: bottom_row ? 'draw' : undefined, about: 6 }, { span: ys, about: 5 });
    q.trace.forEach((line, c) => {
      const path = line.map((v, k) => v === null ? '' : `${k && line[k - 1] !== null ? 'L' : 'M'}${scale.sx(data.iterations[k]).toFixed(1)},${scale.sy(v).toFixed(1)}`).join('');
      svg('path', { d: path, fill: 'none', stroke: palette[c % palette.length], 'stroke-width': 0.9, 'stroke-opacity': 0.65 }, root);
    });
    // Counts of ranks against the expected count, one strip a chain. A strip is wide enough for all counts and for the band of chance.
    const reach = 1.1 * Math.max(1.5 * data.spread[i], ...q.ranks.flat().map(n => Math.abs(n - data.expected)));
    const strip = right.height / q.ranks.length, bar = right.width / data.bins;
    q.ranks.forEach((counts, c) => {
      const level = right.top + (c + 0.5) * strip, unit = 0.5 * strip / reach, chance = data.spread[i] * unit;
      svg('rect', { x: right.left, y: level - chance, width: right.width, height: 2 * chance, fill: '#d9dde1' }, root);
      counts.forEach((n, b) => svg('rect', { x: (right.left + b * bar + 0.5).toFixed(1), y: (level - Math.max(0, (n - data.expected) * unit)).toFixed(1), width: (bar - 1).toFixed(1), height: (Math.abs(n - data.expected) * unit).toFixed(1), fill: palette[c % palette.length], 'fill-opacity': 0.75 }, root));
      svg('line', { x1: right.left, x2: right.left + right.width, y1: level, y2: level, stroke: '#1b1f24', 'stroke-width': 0.8, 'stroke-dasharray': '3 3' }, root);
      if (c) svg('line', { x1: right.left, x2: right.left + right.width, y1: right.top + c * strip, y2: right.top + c * strip, stroke: '#8c959f', 'stroke-width': 0.6 }, root);
    });
    svg('rect', { class: 'frame', x: right.left, y: right.top, width: right.width, height: right.height }, root);
    if (bottom_row) svg('text', { x: right.left + right.width / 2, y: right.top + right.height + 37, 'text-anchor': 'middle' }, root, 'rank among all draws, from low to high');
  });
  let lx = 92;
  const ly = rows * height + bottom - 8;
  for (let c = 0; c < data.chains; ++c) {
    svg('line', { x1: lx, x2: lx + 22, y1: ly - 4, y2: ly - 4, stroke: palette[c % palette.length], 'stroke-width': 2.2 }, root);
    svg('text', { x: lx + 28, y: ly }, root, `chain ${c + 1}`);
    lx += 88;
    if (lx > 860) break;
  }
  if (data.of > data.chains) svg('text', { x: 948, y: ly, 'text-anchor': 'end' }, root, `the first ${data.chains} of ${data.of} chains`);
}
