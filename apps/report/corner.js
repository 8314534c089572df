'use strict';
// The posterior's corner plot: densities on the diagonal, pairs below it.

/// Segments of the line where a grid of values crosses `level`, by linear interpolation along the edges of its squares (marching squares). `at(r, c)` is 0 beyond the grid, so
/// lines close there. Points are in cells; the centre of the first cell is at 0.
function contour(at, n, level) {
  const path = [];
  const cross = (a, b) => (level - a) / (b - a);
  for (let r = -1; r < n; ++r)
    for (let c = -1; c < n; ++c) {
      const v = [at(r, c), at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)], hits = [];
      if ((v[0] > level) !== (v[1] > level)) hits.push([c + cross(v[0], v[1]), r]);
      if ((v[1] > level) !== (v[2] > level)) hits.push([c + 1, r + cross(v[1], v[2])]);
      if ((v[3] > level) !== (v[2] > level)) hits.push([c + cross(v[3], v[2]), r + 1]);
      if ((v[0] > level) !== (v[3] > level)) hits.push([c, r + cross(v[0], v[3])]);
      for (let k = 0; k + 1 < hits.length; k += 2) path.push([hits[k], hits[k + 1]]);
    }
  return path;
}

function draw_corner(place, data) {
  if (!place || !data) return;
  const n = data.axes.length, left = 112, gap = 12, size = n === 1 ? 360 : Math.max(118, Math.floor((800 - left - gap * n) / n)), step = size + gap;
  const most = Math.floor(size / 7.2), lines = data.axes.map(a => label_lines(a.label, most)), deepest = Math.max(...lines.map(l => l.length));
  const width = Math.max(left + n * step, 560), height = n * step + 74 + 16 * (deepest - 1) + (data.marks.length > 4 ? 20 : 0), root = svg('svg', { class: 'drawing', viewBox: `0 0 ${width} ${height}` }, place);
  const defs = svg('defs', {}, root), about = 4;
  // The room for their numbers limits the number of ticks.
  const about_x = span => [5, 4, 3, 2].find(k => {
    const t = ticks(span[0], span[1], k);
    return t.list.length * (14 + 7.4 * Math.max(...t.list.map(v => number(v, t.step).length))) < 0.85 * size;
  }) || 1;
  const colour = (label, k) => (series_style[label.toLowerCase()] || { color: palette[k % palette.length] }).color;
  const cell = (i, j) => ({ left: left + i * step, top: 8 + j * step, width: size, height: size });
  const clip_to = (box, i, j) => {
    svg('rect', { x: box.left, y: box.top, width: box.width, height: box.height }, svg('clipPath', { id: `corner-${i}-${j}` }, defs));
    return `url(#corner-${i}-${j})`;
  };
  const bottom = j => j === n - 1;
  const x_axis = (i, j) => ({ span: data.axes[i].span, about: about_x(data.axes[i].span), labels: bottom(j) });
  const write = (list, x, y, turned) => list.forEach((text, l) => {
    const at = turned ? { transform: `translate(${x + 16 * (l - list.length + 1)},${y}) rotate(-90)` } : { x, y: y + 16 * l };
    svg('text', Object.assign({ 'text-anchor': 'middle' }, at), root, text);
  });

  data.axes.forEach((a, k) => {
    const box = cell(k, k), highest = Math.max(...a.density, 1e-300);
    const scale = axes(root, box, x_axis(k, k), { span: [0, 1.12], labels: false, about: 2 });
    const x = i => scale.sx(a.span[0] + (a.span[1] - a.span[0]) * i / (a.density.length - 1));
    const line = a.density.map((v, i) => `${x(i).toFixed(1)},${scale.sy(v / highest).toFixed(1)}`);
    const clip = clip_to(box, k, k);
    svg('polygon', { points: [`${x(0)},${scale.sy(0)}`, ...line, `${x(a.density.length - 1)},${scale.sy(0)}`].join(' '), fill: '#5b7c99', 'fill-opacity': 0.22, 'clip-path': clip }, root);
    svg('polyline', { points: line.join(' '), fill: 'none', stroke: '#33526e', 'stroke-width': 1.8, 'clip-path': clip }, root);
    for (const q of [a.q05, a.q50, a.q95])
      svg('line', { x1: scale.sx(q), x2: scale.sx(q), y1: box.top, y2: box.top + box.height, stroke: '#33526e', 'stroke-width': 1, 'stroke-dasharray': q === a.q50 ? '' : '3 3', 'clip-path': clip }, root);
    data.marks.forEach((m, i) => {
      const v = m.values[k];
      if (v === null || v < a.span[0] || v > a.span[1]) return;
      const at = scale.sx(v);
      svg('title', {}, svg('path', { d: `M${at},${box.top + 11}l-5,-10h10z`, fill: colour(m.label, i), stroke: '#fff', 'stroke-width': 0.8 }, root), `${m.label}: ${number(v)}`);
    });
    if (k === 0 && n > 1) write(['probability', 'density'], box.left - 8, box.top + box.height / 2, true);
    if (bottom(k) || n === 1) write(lines[k], box.left + box.width / 2, box.top + box.height + 37);
  });

  data.pairs.forEach(p => {
    const a = data.axes[p.i], b = data.axes[p.j], box = cell(p.i, p.j);
    const y = { span: b.span, about, labels: p.i === 0 };
    const scale = axes(root, box, x_axis(p.i, p.j), y), clip = clip_to(box, p.i, p.j);
    if (p.i === 0) write(lines[p.j], box.left - 62, box.top + box.height / 2, true);
    if (bottom(p.j)) write(lines[p.i], box.left + box.width / 2, box.top + box.height + 37);
    const dots = data.points.map(r => `M${scale.sx(r[p.i]).toFixed(1)},${scale.sy(r[p.j]).toFixed(1)}h0`).join('');
    svg('path', { d: dots, stroke: '#5b7c99', 'stroke-width': 2.2, 'stroke-linecap': 'round', 'stroke-opacity': 0.28, 'clip-path': clip }, root);
    const at = (r, c) => r < 0 || c < 0 || r >= p.cells || c >= p.cells ? 0 : p.density[r * p.cells + c];
    const to = ([c, r]) => `${(box.left + box.width * (c + 0.5) / p.cells).toFixed(1)},${(box.top + box.height * (1 - (r + 0.5) / p.cells)).toFixed(1)}`;
    for (const [level, width] of [[p.level90, 1.1], [p.level50, 1.9]])
      svg('path', { d: contour(at, p.cells, level).map(s => `M${to(s[0])}L${to(s[1])}`).join(''), fill: 'none', stroke: '#1f3b55', 'stroke-width': width, 'clip-path': clip }, root);
    if (data.ridge && data.ridge.i === p.i && data.ridge.j === p.j) {
      let path = '';
      for (let k = 0; k <= 120; ++k) {
        const x = a.span[0] + (a.span[1] - a.span[0]) * k / 120;
        if (x > 0) path += `${path ? 'L' : 'M'}${scale.sx(x).toFixed(1)},${scale.sy(data.ridge.product / x).toFixed(1)}`;
      }
      svg('path', { class: 'corner-ridge', d: path, fill: 'none', stroke: '#d55e00', 'stroke-width': 1.5, 'stroke-dasharray': '6 4', 'clip-path': clip }, root);
    }
    const taken = [];
    data.marks.forEach((m, i) => {
      const u = m.values[p.i], v = m.values[p.j];
      if (u === null || v === null) return;
      const inside = u >= a.span[0] && u <= a.span[1] && v >= b.span[0] && v <= b.span[1];
      let cx = Math.min(Math.max(scale.sx(u), box.left), box.left + box.width), cy = Math.min(Math.max(scale.sy(v), box.top), box.top + box.height);
      // A point outside the frame is an arrow on its edge towards the point, behind earlier arrows.
      const angle = Math.atan2(scale.sy(v) - cy, scale.sx(u) - cx) * 180 / Math.PI, back = 11 * taken.filter(t => Math.hypot(t[0] - cx, t[1] - cy) < 8).length;
      if (!inside) {
        taken.push([cx, cy]);
        cx -= back * Math.cos(angle * Math.PI / 180);
        cy -= back * Math.sin(angle * Math.PI / 180);
      }
      const mark = inside ? svg('circle', { cx, cy, r: 4.6, fill: colour(m.label, i), stroke: '#fff', 'stroke-width': 1.2 }, root)
        : svg('path', { d: 'M3,0L-9,-5.5L-9,5.5Z', transform: `translate(${cx.toFixed(1)},${cy.toFixed(1)}) rotate(${angle.toFixed(1)})`, fill: colour(m.label, i), stroke: '#fff', 'stroke-width': 1 }, root);
      svg('title', {}, mark, `${m.label}: ${number(u)}, ${number(v)}${inside ? '' : ' (outside of the frame)'}`);
    });
  });

  // The legend of marks and lines, below the plot.
  let lx = left, ly = height - 8 - (data.marks.length > 4 ? 20 : 0);
  const word = (text, room) => {
    svg('text', { x: lx + room, y: ly }, root, text);
    lx += room + 14 + 7.4 * text.length;
  };
  svg('path', { d: `M${lx},${ly - 4}h26`, stroke: '#1f3b55', 'stroke-width': 1.9 }, root);
  word('50, 90 % of the draws', 32);
  if (data.ridge) {
    svg('path', { d: `M${lx},${ly - 4}h26`, stroke: '#d55e00', 'stroke-width': 1.5, 'stroke-dasharray': '6 4' }, root);
    word('\u03c1c = const', 32);
  }
  data.marks.forEach((m, i) => {
    if (lx + 14 + 7.4 * m.label.length > width) lx = left, ly += 20;
    svg('circle', { cx: lx + 5, cy: ly - 4, r: 4.6, fill: colour(m.label, i) }, root);
    word(m.label, 14);
  });
}
