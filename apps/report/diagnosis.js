'use strict';
// Drawings of a diagnosis: the mismatch on the target, by gauge and time and by gauge and frequency, and the probabilities of the explanations.

/// Colour [r, g, b] of a mismatch: white when errors alone explain it (1 or less), darker up to `most` (after ColorBrewer's YlOrBr).
function mismatch_colour(x, most) {
  const stops = [[255, 255, 255], [254, 227, 145], [254, 153, 41], [204, 76, 2], [102, 37, 6]];
  const t = Math.min(Math.max((x - 1) / (most - 1), 0), 1) * (stops.length - 1), i = Math.min(Math.floor(t), stops.length - 2);
  return stops[i].map((a, k) => a + (stops[i + 1][k] - a) * (t - i));
}

/// End of the colour scale: the greatest mismatch, but at least 3, so that chance is pale.
function mismatch_most(data) {
  let most = 3;
  for (const list of [data.rows, ...[data.times, data.bands].flatMap(m => [m.columns, ...m.cells])]) for (const p of list) if (p.mismatch !== null) most = Math.max(most, p.mismatch);
  return most;
}

const times_text = x => x === null ? '\u2013' : x < 9.95 ? x.toFixed(1) : x.toFixed(0);

function mismatch_cell(root, box, part, most) {
  const c = part.mismatch === null ? [240, 240, 240] : mismatch_colour(part.mismatch, most), dark = c[0] + c[1] + c[2] < 420;
  svg('rect', { x: box.x, y: box.y, width: box.width, height: box.height, fill: rgb(c), stroke: '#d0d7de', 'stroke-width': 0.7 }, root);
  if (part.significant) svg('rect', { x: box.x + 1.5, y: box.y + 1.5, width: box.width - 3, height: box.height - 3, fill: 'none', stroke: '#1b1f24', 'stroke-width': 2 }, root);
  const style = { x: box.x + box.width / 2, y: box.y + box.height / 2 + 4.5, 'text-anchor': 'middle', 'font-weight': part.significant ? 700 : 400, style: `fill:${dark ? '#fff' : '#1b1f24'}` };
  svg('text', style, root, times_text(part.mismatch));
}

/// Map of gauges by windows of time or bands of frequency, `map` {axis, columns, cells}. The last row is all gauges together, the last column the whole record.
function draw_mismatch_map(place, data, map) {
  if (!place || !data || !map.columns.length) return;
  const most = mismatch_most(data), longest = Math.max(10, ...data.rows.map(r => r.name.length)), left = Math.min(30 + 7.6 * longest, 260), n = map.columns.length;
  const gap = 10, width = (960 - left - gap - 8) / (n + 1), height = 26, top = 46, rows = data.rows.length;
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 960 ${top + height * (rows + 1) + gap + 8}` }, place);
  svg('text', { x: left + n * width / 2, y: 15, 'text-anchor': 'middle' }, root, map.axis);
  map.columns.forEach((c, w) => svg('text', { x: left + (w + 0.5) * width, y: top - 8, 'text-anchor': 'middle' }, root, c.label));
  svg('text', { x: left + gap + (n + 0.5) * width, y: top - 8, 'text-anchor': 'middle', 'font-weight': 600 }, root, 'whole record');
  data.rows.forEach((r, i) => {
    const y = top + i * height;
    svg('text', { x: left - 8, y: y + height / 2 + 4.5, 'text-anchor': 'end' }, root, r.name);
    (map.cells[i] || []).forEach((p, w) => mismatch_cell(root, { x: left + w * width, y, width, height }, p, most));
    mismatch_cell(root, { x: left + gap + n * width, y, width, height }, r, most);
  });
  const y = top + rows * height + gap;
  svg('text', { x: left - 8, y: y + height / 2 + 4.5, 'text-anchor': 'end', 'font-weight': 600 }, root, 'all gauges');
  map.columns.forEach((c, w) => mismatch_cell(root, { x: left + w * width, y, width, height }, c, most));
}

function draw_probabilities(place, data) {
  if (!place || !data || !data.bars.length) return;
  const labels = data.bars.map(b => label_lines(b.label, 88)), longest = Math.max(...labels.flat().map(l => l.length));
  const left = 20 + 7 * Math.min(longest, 84), height = 24, line = 16, width = 960 - left - 90;
  const root = svg('svg', { class: 'drawing', viewBox: `0 0 960 ${height * data.bars.length + line * (labels.flat().length - labels.length) + 8}` }, place);
  let y = 4;
  data.bars.forEach((b, i) => {
    const weight = b.strong ? 700 : 400;
    labels[i].forEach((text, n) => svg('text', { x: left - 10, y: y + 15 + n * line, 'text-anchor': 'end', 'font-weight': weight }, root, text));
    svg('rect', { x: left, y: y + 2, width, height: height - 6, fill: '#f0f2f4' }, root);
    svg('rect', { x: left, y: y + 2, width: width * b.probability, height: height - 6, fill: b.strong ? '#0b5394' : '#9fb3c4' }, root);
    svg('text', { x: left + width + 8, y: y + 15, 'font-weight': weight }, root, b.probability < 0.001 ? '< 0.1 %' : b.probability > 0.999 ? '> 99.9 %' : `${(100 * b.probability).toFixed(1)} %`);
    y += height + line * (labels[i].length - 1);
  });
}

/// The gauges of the target coloured by mismatch, and the walls around them. A wall has the mean of the gauges, weighted by a Gaussian of their distance; far from all
/// gauges it fades to the grey of steel.
function draw_mismatch_target(view, scale_place, note, target, data) {
  if (!view || !target || !data) return;
  const most = mismatch_most(data), of = new Map(data.gauges.map(g => [g.name, g]));
  const sensors = target.sensors.map(s => {
    const g = of.get(s.name);
    if (!g || g.mismatch === null) return Object.assign({}, s, { colour: surface_colours.outer, label: `${s.name} \u2013` });
    return Object.assign({}, s, { colour: mismatch_colour(g.mismatch, most), label: `${s.name} ${times_text(g.mismatch)}` });
  });
  const known = sensors.filter(s => of.has(s.name) && of.get(s.name).mismatch !== null).map(s => ({ at: s.position, mismatch: of.get(s.name).mismatch }));
  const radius = 0.16 * target_extent(target).radius;
  const paint = p => {
    let sum = 0, weight = 0, near = 0;
    for (const k of known) {
      const r = Math.hypot(p[0] - k.at[0], p[1] - k.at[1], p[2] - k.at[2]) / radius, w = Math.exp(-0.5 * r * r);
      sum += w * k.mismatch;
      weight += w;
      near = Math.max(near, w);
    }
    if (near < 1e-3) return surface_colours.outer;
    const c = mismatch_colour(sum / weight, most), share = Math.min(1, 1.6 * near);
    return surface_colours.outer.map((grey, i) => grey + share * (c[i] - grey));
  };
  draw_target(view, note, Object.assign({}, target, { sensors }), paint);
  if (!scale_place) return;
  const root = svg('svg', { class: 'drawing', viewBox: '0 0 800 44', style: 'max-width:50rem' }, scale_place), left = 10, width = 330;
  for (let i = 0; i < 80; ++i) svg('rect', { x: left + width * i / 80, y: 4, width: width / 80 + 0.6, height: 14, fill: rgb(mismatch_colour(1 + (most - 1) * (i + 0.5) / 80, most)) }, root);
  svg('rect', { class: 'frame', x: left, y: 4, width, height: 14 }, root);
  const scale = ticks(1, most, 5);
  for (const v of [1, ...scale.list.filter(v => v > 1.01)]) svg('text', { x: left + width * (v - 1) / (most - 1), y: 34, 'text-anchor': 'middle' }, root, number(v, v === 1 ? 1 : scale.step));
  svg('text', { x: left + width + 20, y: 17 }, root, 'mismatch, times the errors; 1 and less: no more than errors make');
}
