'use strict';
// Measured band and mean and the simulations of every sensor: one Dygraph each, zoomed together in time.

const series_style = {
  measured: { color: '#4d4d4d', strokeWidth: 1.2 },
  nominal: { color: '#d55e00', strokeWidth: 1.3, strokePattern: [6, 3] },
  enc: { color: '#0072b2', strokeWidth: 1.6 },
  spe: { color: '#008a63', strokeWidth: 1.6, strokePattern: [2, 2] },
  map: { color: '#b35a8c', strokeWidth: 1.6, strokePattern: [9, 3, 2, 3] },
  base: { color: '#d55e00', strokeWidth: 1.4, strokePattern: [6, 3] },
  explained: { color: '#0072b2', strokeWidth: 1.6 },
  held_out_explained: { color: '#008a63', strokeWidth: 1.6, strokePattern: [2, 2] },
  predicted: { color: '#0072b2', strokeWidth: 1.2 },
  draws: { color: '#d55e00', strokeWidth: 0.01 },
  held_out_base: { color: '#7a5c00', strokeWidth: 1.4, strokePattern: [9, 3, 2, 3] },
};

function element(tag, attributes, parent, text) {
  const node = document.createElement(tag);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.appendChild(node);
  return node;
}

/// Lower and upper edge of a series' band: "low" and "high" of the records, KEY_low and KEY_high of other series.
const band_edges = key => key === 'measured' ? ['low', 'high'] : [`${key}_low`, `${key}_high`];
const banded_keys = ['measured', 'predicted', 'draws'];

/// Rows of Dygraph's custom bars: every series is [low, value, high]. Without a band both edges are the value.
function history_rows(time, series, sensor) {
  return time.map((t, i) => [t].concat(series.map(s => {
    const v = sensor[s.key] ? sensor[s.key][i] : null;
    if (v === null || v === undefined) return [null, null, null];
    const [below, above] = band_edges(s.key), low = sensor[below] ? sensor[below][i] : v, high = sensor[above] ? sensor[above][i] : v;
    return [low === null ? v : low, v, high === null ? v : high];
  })));
}

function key_image(series, banded) {
  const style = series_style[series.key];
  const root = svg('svg', { class: 'key', viewBox: '0 0 30 12', 'aria-hidden': 'true' });
  if (banded) svg('rect', { x: 0, y: 1, width: 30, height: 10, fill: style.color, 'fill-opacity': 0.22 }, root);
  if (style.strokeWidth > 0.1) svg('line', { x1: 0, x2: 30, y1: 6, y2: 6, stroke: style.color, 'stroke-width': 2, 'stroke-dasharray': (style.strokePattern || []).join(' ') }, root);
  return root;
}

function draw_histories(place, controls, data) {
  if (!place || !data) return [];
  const used = data.series.filter(s => data.conditions.some(c => c.sensors.some(x => x[s.key])));
  const graphs = [], first = data.time[0], last = data.time[data.time.length - 1];

  for (const condition of data.conditions) {
    if (data.conditions.length > 1) element('h3', {}, place, `Condition ${condition.name}`);
    for (const sensor of condition.sensors) {
      const box = element('figure', { class: 'history' }, place);
      const caption = element('figcaption', {}, box);
      element('b', {}, caption, sensor.name);
      element('span', {}, caption, data.scores[`${sensor.name} (${condition.name})`] || data.scores[sensor.name] || '');
      const div = element('div', { class: 'plot', role: 'img', 'aria-label': `Strain history of sensor ${sensor.name}` }, box);
      const readout = element('div', { class: 'readout' }, box);
      const own = used.filter(s => sensor[s.key]);
      const options = {
        labels: ['time'].concat(own.map(s => s.label)), customBars: true, fillAlpha: 0.22, series: {}, labelsDiv: element('div', { hidden: '' }),
        xlabel: `time [${data.time_unit}]`, ylabel: data.unit, xLabelHeight: 16, yLabelWidth: 16, axisLabelFontSize: 12, gridLineColor: '#e4e8ec', axisLineColor: '#8c959f',
        axes: { y: { axisLabelWidth: 52, pixelsPerLabel: 28 }, x: { pixelsPerLabel: 70 } },
        visibility: own.map(s => !s.hidden), connectSeparatedPoints: false, xRangePad: 0, yRangePad: 6, highlightCircleSize: 3, animatedZooms: false, legend: 'never',
        highlightCallback: (event, x, points) => {
          readout.textContent = `${number(x)} ${data.time_unit}:  ` + points.filter(p => isFinite(p.yval)).map(p => `${p.name} ${number(p.yval)}`).join(';  ') + ` [${data.unit}]`;
        },
        unhighlightCallback: () => { readout.textContent = ''; },
      };
      own.forEach(s => { options.series[s.label] = series_style[s.key]; });
      const graph = new Dygraph(div, history_rows(data.time, own, sensor), options);
      graphs.push({ graph, keys: own.map(s => s.key) });
    }
  }
  if (!graphs.length) return [];
  if (graphs.length > 1) Dygraph.synchronize(graphs.map(g => g.graph), { zoom: true, selection: false, range: false });

  for (const s of used) {
    const label = element('label', {}, controls);
    const box = element('input', Object.assign({ type: 'checkbox' }, s.hidden ? {} : { checked: '' }), label);
    label.appendChild(key_image(s, banded_keys.includes(s.key) && data.conditions.some(c => c.sensors.some(x => x[band_edges(s.key)[0]]))));
    label.appendChild(document.createTextNode(s.label));
    box.addEventListener('change', () => graphs.forEach(g => {
      const at = g.keys.indexOf(s.key);
      if (at >= 0) g.graph.setVisibility(at, box.checked);
    }));
  }
  const range = element('span', { class: 'range' }, controls);
  const inputs = [['from', first], ['to', last]].map(([name, value]) => {
    const label = element('label', {}, range, `${name} `);
    const input = element('input', { type: 'number', step: 'any', value: String(value), 'aria-label': `show ${name} time in ${data.time_unit}` }, label);
    return input;
  });
  element('span', {}, range, ` ${data.time_unit} `);
  const zoom = (low, high) => graphs[0].graph.updateOptions({ dateWindow: [low, high] });
  inputs.forEach(input => input.addEventListener('change', () => {
    const [low, high] = inputs.map(i => Number(i.value));
    if (high > low) zoom(low, high);
  }));
  const reset = element('button', { type: 'button' }, controls, 'Show whole record');
  reset.addEventListener('click', () => zoom(first, last));
  graphs[0].graph.updateOptions({
    drawCallback: merge_callbacks(graphs[0].graph.getFunctionOption('drawCallback'), g => {
      const window_now = g.xAxisRange();
      inputs.forEach((input, i) => { if (document.activeElement !== input) input.value = number(window_now[i]).replace('\u2212', '-'); });
    }),
  }, true);
  if (data.thinned) element('p', { class: 'note' }, place.parentNode, `Traces of ${data.samples} samples are thinned for this page; each window keeps its least and greatest value. report --csv gives them whole.`);
  return graphs;
}

function merge_callbacks(first, second) {
  return function () {
    if (first) first.apply(this, arguments);
    second.apply(this, arguments);
  };
}
