'use strict';
// All drawings use the one block of data. A drawing that fails shows a message in its place and does not affect the others.
(function () {
  const data = JSON.parse(document.getElementById('report-data').textContent);
  const attempt = (id, draw) => {
    try {
      draw();
    } catch (error) {
      const place = document.getElementById(id);
      if (place) element('p', { class: 'missing' }, place, `This drawing could not be made: ${error.message}`);
      console.error(error);
    }
  };
  const histories = (plots, controls, traces) => attempt(plots, () => draw_histories(document.getElementById(plots), document.getElementById(controls), traces));
  histories('diagnosis-plots', 'diagnosis-controls', data.diagnosis_histories);
  histories('histories-plots', 'history-controls', data.histories);
  attempt('mismatch-map', () => draw_mismatch_map(document.getElementById('mismatch-map'), data.diagnosis, data.diagnosis.times));
  attempt('mismatch-bands', () => draw_mismatch_map(document.getElementById('mismatch-bands'), data.diagnosis, data.diagnosis.bands));
  attempt('probability-bars', () => draw_probabilities(document.getElementById('probability-bars'), data.diagnosis));
  attempt('mismatch-view', () => draw_mismatch_target(document.getElementById('mismatch-view'), document.getElementById('mismatch-scale'), document.getElementById('mismatch-note'), data.target, data.diagnosis));
  attempt('convergence-plot', () => draw_lines(document.getElementById('convergence-plot'), data.convergence, false));
  attempt('loss-plot', () => draw_lines(document.getElementById('loss-plot'), data.loss, true));
  (data.decay || []).forEach((figure, i) => attempt(`decay-plot-${i}`, () => draw_lines(document.getElementById(`decay-plot-${i}`), figure, false)));
  attempt('ridge-plot', () => draw_ridge(document.getElementById('ridge-plot'), data.ridge));
  histories('predictive-plots', 'predictive-controls', data.predictive);
  attempt('prior-plot', () => draw_priors(document.getElementById('prior-plot'), data.priors));
  attempt('chain-plot', () => draw_chains(document.getElementById('chain-plot'), data.chains));
  attempt('corner-plot', () => draw_corner(document.getElementById('corner-plot'), data.corner));
  attempt('sensitivity-map', () => draw_sensitivity_map(document.getElementById('sensitivity-map'), data.sensitivity));
  attempt('sensitivity-curves', () => draw_sensitivity_curves(document.getElementById('sensitivity-curves'), document.getElementById('sensitivity-controls'), data.sensitivity));
  attempt('sensitivity-morris', () => draw_morris(document.getElementById('sensitivity-morris'), data.sensitivity));
  attempt('design-plot', () => draw_design(document.getElementById('design-plot'), data.design));
  attempt('target-view', () => draw_target(document.getElementById('target-view'), document.getElementById('target-note'), data.target));
  document.documentElement.setAttribute('data-drawn', 'yes');
})();
