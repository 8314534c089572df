'use strict';
// Drawings of the sensitivity analysis: total indices by gauge and time, index curves of one gauge, elementary effects.

/// Colour of a share: white at 0 and below, dark at 1 and above (after ColorBrewer's Blues).
function share_colour(x) {
  const stops = [[255, 255, 255], [222, 235, 247], [158, 202, 225], [66, 146, 198], [8, 81, 156], [8, 30, 70]];
  const t = Math.min(Math.max(x, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(t), stops.length - 2);
  return `rgb(${stops[i].map((a, k) => Math.round(a + (stops[i + 1][k] - a) * (t - i))).join(',')})`;
}

/// A pattern of thin strokes for shares that mean little.
function hatch(root, id) {
  const pattern = svg('pattern', { id, width: 6, height: 6, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)' }, svg('defs', {}, root));
  svg('rect', { width: 6, height: 6, fill: '#f4f4f4' }, pattern);
  svg('line', { x1: 0, y1: 0, x2: 0, y2: 6, stroke: '#c4c8cc', 'stroke-width': 1.6 }, pattern);
  return `url(#${id})`;
}

/// One panel a parameter, one row a gauge, one cell a window of time.
function draw_sensitivity_map(place, data) {
  if (!place || !data || !data.map) return;
  const rows = data.rows.length, row = Math.max(9, Math.min(20, 260 / rows)), longest = Math.max(...data.rows.map(r => r.length));
  const left = Math.min(20 + 7.6 * longest, 240), width = 960 - left - 14, title = 26, panel = title + rows * row, bottom = 64;
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 960 ${data.parameters.length * (panel + 8) + bottom}` }, place);
  const little = hatch(root, 'sensitivity-hatch'), first = data.map.begin[0], last = data.map.end[data.map.end.length - 1];
  const sx = t => left + width * (t - first) / (last - first);
  data.parameters.forEach((name, k) => {
    const top = k * (panel + 8) + title;
    svg('text', { x: left, y: top - 8, 'font-weight': 600 }, root, name);
    data.rows.forEach((label, r) => {
      const y = top + r * row;
      if (row > 11) svg('text', { x: left - 8, y: y + row / 2 + 4.5, 'text-anchor': 'end' }, root, label);
      data.map.total[k][r].forEach((x, w) => {
        const from = sx(data.map.begin[w]), to = sx(data.map.end[w]);
        svg('rect', { x: from.toFixed(1), y, width: (to - from + 0.2).toFixed(1), height: row, fill: x === null ? little : share_colour(x), 'shape-rendering': 'crispEdges' }, root);
      });
    });
    for (let r = 1; r < rows; ++r) svg('line', { x1: left, x2: left + width, y1: top + r * row, y2: top + r * row, stroke: '#fff', 'stroke-width': 1 }, root);
    svg('rect', { class: 'frame', x: left, y: top, width, height: rows * row }, root);
  });
  const base = data.parameters.length * (panel + 8) - 8;
  for (const t of ticks(Math.max(first, 0), last, 9).list) {
    svg('line', { x1: sx(t), x2: sx(t), y1: base, y2: base + 5, stroke: '#8c959f' }, root);
    svg('text', { x: sx(t), y: base + 19, 'text-anchor': 'middle' }, root, number(t));
  }
  svg('text', { x: left + width, y: base + 40, 'text-anchor': 'end' }, root, `time [${data.time_unit}]`);
  // The scale of the colours.
  const scale = 240, y = base + 32;
  for (let i = 0; i < 60; ++i) svg('rect', { x: left + scale * i / 60, y, width: scale / 60 + 0.6, height: 12, fill: share_colour((i + 0.5) / 60) }, root);
  svg('rect', { class: 'frame', x: left, y, width: scale, height: 12 }, root);
  for (const v of [0, 0.25, 0.5, 0.75, 1]) svg('text', { x: left + scale * v, y: y + 26, 'text-anchor': 'middle' }, root, String(v));
  svg('text', { x: left + scale + 16, y: y + 11 }, root, 'total index');
  svg('rect', { class: 'frame', x: left + scale + 110, y, width: 26, height: 12, style: `fill:${little}` }, root);
  svg('text', { x: left + scale + 144, y: y + 11 }, root, 'hardly varies');
}

/// Lines of a list that may have gaps.
function broken_path(xs, ys) {
  let path = '', pen = 'M';
  ys.forEach((y, i) => {
    if (y === null) { pen = 'M'; return; }
    path += `${pen}${xs[i].toFixed(1)},${y.toFixed(1)}`;
    pen = 'L';
  });
  return path;
}

/// Indices over time of one gauge, chosen in `controls`.
function draw_sensitivity_curves(place, controls, data) {
  if (!place || !data || !data.curves) return;
  const draw = r => {
    place.textContent = '';
    const longest = Math.max(...data.parameters.map(p => p.length)), columns = Math.max(1, Math.floor(870 / (60 + 7.6 * longest))), lines = Math.ceil(data.parameters.length / columns);
    const root = svg('svg', { class: 'drawing', viewBox: `0 0 960 ${462 + 20 * lines}` }, place);
    const c = data.curves, of = data.parameters.map((_, k) => ({ total: c.total[k][r], first: c.first[k][r] }));
    const all = of.flatMap(o => o.total.concat(o.first)).filter(x => x !== null);
    const ys = [Math.min(0, ...all), Math.max(1, ...all)], room = 0.03 * (ys[1] - ys[0]);
    const xs = [Math.min(0, c.time[0]), c.time[c.time.length - 1]];
    const box = { left: 78, top: 10, width: 870, height: 280 }, below = { left: 78, top: 314, width: 870, height: 90 };
    const scale = axes(root, box, { span: xs, labels: false, about: 9 }, { span: [ys[0] - room, ys[1] + room], label: 'share of the variance' });
    const at = c.time.map(scale.sx);
    of.forEach((o, k) => {
      const colour = palette[k % palette.length];
      for (const [list, width, dash] of [[o.first, 1.3, '5 3'], [o.total, 2, '']])
        svg('path', { d: broken_path(at, list.map(x => x === null ? null : scale.sy(x))), fill: 'none', stroke: colour, 'stroke-width': width, 'stroke-dasharray': dash }, root);
      const lx = box.left + (k % columns) * (box.width / columns), ly = 462 + 20 * Math.floor(k / columns);
      svg('line', { x1: lx, x2: lx + 34, y1: ly - 4, y2: ly - 4, stroke: colour, 'stroke-width': 2.4 }, root);
      svg('text', { x: lx + 42, y: ly }, root, data.parameters[k]);
    });
    const sd = c.sd[r], most = Math.max(...sd.filter(x => x !== null), 1e-300);
    const foot = axes(root, below, { span: xs, label: `time [${data.time_unit}]`, about: 9 }, { span: [0, 1.08 * most], about: 3, label: `sd [${data.unit}]` });
    const top = sd.map((x, i) => `${at[i].toFixed(1)},${foot.sy(x === null ? 0 : x).toFixed(1)}`);
    svg('polygon', { points: [`${at[0]},${foot.sy(0)}`, ...top, `${at[at.length - 1]},${foot.sy(0)}`].join(' '), fill: '#5b7c99', 'fill-opacity': 0.3, stroke: '#33526e', 'stroke-width': 1 }, root);
  };
  if (data.rows.length > 1 && controls) {
    const label = element('label', {}, controls, 'Gauge '), select = element('select', {}, label);
    data.rows.forEach((name, r) => element('option', { value: String(r) }, select, name));
    select.addEventListener('change', () => draw(Number(select.value)));
  }
  draw(0);
}

/// Mean of the absolute effects against their standard deviation, one panel a kind of number, one colour a parameter.
function draw_morris(place, data) {
  if (!place || !data || !data.morris.length) return;
  const n = data.morris.length, columns = Math.min(n, 3), width = 960 / Math.max(columns, 2), height = 300, rows = Math.ceil(n / columns);
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 ${width * columns} ${height * rows + 30}`, style: `max-width:${width * columns}px` }, place);
  data.morris.forEach((m, i) => {
    const box = { left: (i % columns) * width + 72, top: Math.floor(i / columns) * height + 26, width: width - 92, height: height - 84 };
    svg('text', { x: box.left, y: box.top - 9, 'font-weight': 600 }, root, m.title);
    const x_most = 1.08 * Math.max(...m.points.map(p => p.mu_star), 1e-300), y_most = 1.08 * Math.max(...m.points.map(p => p.sigma), 1e-12 * x_most);
    const scale = axes(root, box, { span: [0, x_most], about: 4, label: `mean change [${m.unit}]` }, { span: [0, y_most], about: 4, label: `sd of the change [${m.unit}]`, label_at: box.left - 56 });
    const end = Math.min(x_most, y_most);
    svg('line', { x1: scale.sx(0), y1: scale.sy(0), x2: scale.sx(end), y2: scale.sy(end), stroke: '#8c959f', 'stroke-dasharray': '5 4' }, root);
    m.points.forEach(p => {
      const style = { cx: scale.sx(p.mu_star), cy: scale.sy(p.sigma), r: p.record === 'all records' ? 6 : 4.2, fill: palette[p.parameter % palette.length], 'fill-opacity': 0.75, stroke: '#fff', 'stroke-width': 0.8 };
      svg('title', {}, svg('circle', style, root), `${p.record}, ${data.parameters[p.parameter]}: ${number(p.mu_star)}, ${number(p.sigma)} ${m.unit}`);
    });
  });
  let lx = 72;
  data.parameters.forEach((name, k) => {
    svg('circle', { cx: lx + 5, cy: height * rows + 12, r: 4.6, fill: palette[k % palette.length] }, root);
    svg('text', { x: lx + 16, y: height * rows + 16.5 }, root, name);
    lx += 40 + 7.6 * name.length;
  });
}
