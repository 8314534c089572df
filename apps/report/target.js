'use strict';
// The target in three dimensions: by three.js when the browser has WebGL, else painted on a flat canvas.

const surface_colours = { outer: [168, 180, 192], wetted: [120, 160, 190] }, sensor_colour = [179, 60, 0];

/// "rgb(r,g,b)" of a colour [r, g, b].
const rgb = c => `rgb(${c.map(Math.round).join(',')})`;

function has_webgl() {
  try {
    const canvas = document.createElement('canvas');
    return Boolean(window.WebGLRenderingContext && (canvas.getContext('webgl') || canvas.getContext('experimental-webgl')));
  } catch (error) {
    return false;
  }
}

/// Centre and radius of the whole drawing.
function target_extent(data) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = (x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); };
  for (const surface of [data.outer, data.wetted]) if (surface) surface.vertices.forEach((x, i) => take(x, i % 3));
  data.sensors.forEach(s => s.position.forEach(take));
  const centre = low.map((x, k) => (x + high[k]) / 2);
  return { low, high, centre, radius: Math.max(0.5 * Math.hypot(...high.map((x, k) => x - low[k])), 1e-6) };
}

/// Edges of a surface at which it bends by more than 30 degrees, or ends: [x, y, z, x, y, z] each.
function feature_edges(surface) {
  const v = surface.vertices, edges = new Map(), corner = i => [v[3 * i], v[3 * i + 1], v[3 * i + 2]];
  // Corners at one place count as one corner, whatever their numbers.
  const names = new Map(), same = [];
  for (let i = 0; 3 * i < v.length; ++i) {
    const name = corner(i).join(',');
    if (!names.has(name)) names.set(name, i);
    same.push(names.get(name));
  }
  for (let f = 0; f < surface.quads.length; f += 4) {
    const q = surface.quads.slice(f, f + 4), [a, b, c, d] = q.map(corner);
    const e1 = c.map((x, k) => x - a[k]), e2 = d.map((x, k) => x - b[k]);
    const n = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
    const size = Math.hypot(...n) || 1;
    for (let k = 0; k < 4; ++k) {
      const i = same[q[k]], j = same[q[(k + 1) % 4]];
      if (i === j) continue;
      const key = i < j ? `${i},${j}` : `${j},${i}`;
      if (!edges.has(key)) edges.set(key, { ends: [i, j], normals: [] });
      edges.get(key).normals.push(n.map(x => x / size));
    }
  }
  const list = [];
  for (const { ends, normals } of edges.values()) {
    const bent = normals.length !== 2 || Math.abs(normals[0].reduce((s, x, k) => s + x * normals[1][k], 0)) < Math.cos(Math.PI / 6);
    if (bent) list.push([...corner(ends[0]), ...corner(ends[1])]);
  }
  return list;
}

/// HTML labels above the picture. `place(positions)` moves them, [x, y] in pixels each. A label that would cover another one moves down.
function target_labels(view, names) {
  const layer = element('div', { class: 'labels' }, view);
  const nodes = names.map(name => element('span', { class: 'label' }, layer, name));
  return positions => {
    const taken = [];
    positions.forEach((p, i) => {
      const w = nodes[i].offsetWidth, h = nodes[i].offsetHeight;
      let x = Math.min(Math.max(p[0] + 6, 0), view.clientWidth - w), y = Math.min(Math.max(p[1] - h - 3, 0), view.clientHeight - h);
      for (let k = 0; k < 12 && taken.some(t => x < t[0] + t[2] && t[0] < x + w && y < t[1] + t[3] && t[1] < y + h); ++k) y += h * (k % 2 ? -(k + 1) : k + 1);
      taken.push([x, y, w, h]);
      nodes[i].style.transform = `translate(${x.toFixed(1)}px,${y.toFixed(1)}px)`;
    });
  };
}

/// Draws {outer, wetted, sensors: [{name, position, direction, label, colour}]}; label and colour are optional. `paint(position)`, when given, is the colour of the outer
/// surface at a place.
function draw_target(view, note, data, paint) {
  if (!view || !data) return;
  const extent = target_extent(data);
  if (has_webgl()) {
    try {
      draw_target_webgl(view, data, extent, paint);
      return;
    } catch (error) {
      view.textContent = '';
    }
  }
  draw_target_flat(view, data, extent, paint);
  if (note) note.textContent = `This browser has no WebGL, so the picture is painted flat. ${note.textContent}`;
}

function draw_target_webgl(view, data, extent, paint) {
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setClearColor(0xffffff);
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  view.appendChild(renderer.domElement);
  const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(32, 1, extent.radius / 50, extent.radius * 50);
  camera.up.set(0, 0, 1);
  const centre = new THREE.Vector3(...extent.centre);
  camera.position.copy(centre).add(new THREE.Vector3(-0.62, -0.85, 0.62).normalize().multiplyScalar(extent.radius * 3.3));
  scene.add(new THREE.AmbientLight(0xffffff, 0.55));
  const lamp = new THREE.DirectionalLight(0xffffff, 0.5);  // from the eye, a little from above
  lamp.position.set(0, 0.4 * extent.radius, 0);
  lamp.target.position.copy(centre);
  camera.add(lamp);
  scene.add(camera, lamp.target);

  for (const name of ['wetted', 'outer']) {
    const surface = data[name];
    if (!surface) continue;
    const geometry = new THREE.BufferGeometry(), index = [];
    for (let f = 0; f < surface.quads.length; f += 4) {
      const [a, b, c, d] = surface.quads.slice(f, f + 4);
      index.push(a, b, c, a, c, d);
    }
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(surface.vertices, 3));
    geometry.setIndex(index);
    const painted = name === 'outer' && paint, see_through = name === 'outer' && data.wetted && !painted;
    const material = new THREE.MeshLambertMaterial({
      color: painted ? 0xffffff : new THREE.Color(...surface_colours[name].map(x => x / 255)), vertexColors: painted ? THREE.VertexColors : THREE.NoColors, side: THREE.DoubleSide, flatShading: true, transparent: Boolean(see_through),
      opacity: see_through ? 0.45 : 1, depthWrite: !see_through, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    });
    const flat = geometry.toNonIndexed();
    flat.computeVertexNormals();
    if (painted) {
      const places = flat.getAttribute('position'), colours = [];
      for (let i = 0; i < places.count; ++i) colours.push(...paint([places.getX(i), places.getY(i), places.getZ(i)]).map(x => x / 255));
      flat.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
    }
    scene.add(new THREE.Mesh(flat, material));
    const lines = new THREE.BufferGeometry();
    lines.setAttribute('position', new THREE.Float32BufferAttribute(feature_edges(surface).flat(), 3));
    scene.add(new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: name === 'outer' ? 0x57606a : 0x3b6d94 })));
  }
  const size = extent.radius * 0.02;
  for (const s of data.sensors) {
    const at = new THREE.Vector3(...s.position), direction = new THREE.Vector3(...s.direction), colour = new THREE.Color(rgb(s.colour || sensor_colour));
    const line_colour = s.colour ? 0x333333 : colour.getHex();
    for (const hidden of [true, false]) {  // a sensor behind the target shows through it, paler
      const look = { depthTest: !hidden, transparent: true, opacity: hidden ? 0.35 : 1 };
      const ball = new THREE.Mesh(new THREE.SphereGeometry(size, 16, 12), new THREE.MeshBasicMaterial(Object.assign({ color: colour }, look)));
      ball.position.copy(at);
      ball.renderOrder = 3;
      scene.add(ball);
      if (s.colour) {  // a dark rim, so that a pale ball is seen on a pale wall
        const rim = new THREE.Mesh(new THREE.SphereGeometry(1.25 * size, 16, 12), new THREE.MeshBasicMaterial(Object.assign({}, look, { color: 0x333333, side: THREE.BackSide })));
        rim.position.copy(at);
        rim.renderOrder = 2;
        scene.add(rim);
      }
      if (direction.length() === 0) continue;
      const arrow = new THREE.ArrowHelper(direction.clone().normalize(), at, size * 8, line_colour, size * 2.6, size * 1.8);
      for (const part of [arrow.line, arrow.cone]) {
        Object.assign(part.material, look);
        part.renderOrder = 2;
      }
      scene.add(arrow);
    }
  }
  const labels = target_labels(view, data.sensors.map(s => s.label || s.name));
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.target.copy(centre);
  const render = () => {
    renderer.render(scene, camera);
    labels(data.sensors.map(s => {
      const p = new THREE.Vector3(...s.position).project(camera);
      return [(p.x + 1) / 2 * view.clientWidth, (1 - p.y) / 2 * view.clientHeight];
    }));
  };
  const resize = () => {
    renderer.setSize(view.clientWidth, view.clientHeight, false);
    camera.aspect = view.clientWidth / view.clientHeight;
    camera.updateProjectionMatrix();
    render();
  };
  controls.addEventListener('change', render);
  window.addEventListener('resize', resize);
  window.addEventListener('beforeprint', render);
  controls.update();
  resize();
}

/// Painter's algorithm on a flat canvas: faces sorted by depth, shaded by their angle to the eye, in parallel projection.
function draw_target_flat(view, data, extent, paint) {
  const canvas = element('canvas', {}, view), context = canvas.getContext('2d');
  const labels = target_labels(view, data.sensors.map(s => s.label || s.name));
  let turn = -2.2, tilt = 0.5, zoom = 1;
  const lines = { outer: data.outer ? feature_edges(data.outer) : [], wetted: data.wetted ? feature_edges(data.wetted) : [] };

  const render = () => {
    const ratio = window.devicePixelRatio || 1, width = view.clientWidth, height = view.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const ct = Math.cos(turn), st = Math.sin(turn), cp = Math.cos(tilt), sp = Math.sin(tilt);
    const turned = p => {  // to the right, up, towards the eye
      const x = p[0] - extent.centre[0], y = p[1] - extent.centre[1], z = p[2] - extent.centre[2];
      const right = -st * x + ct * y, away = ct * x + st * y;
      return [right, z * cp - away * sp, away * cp + z * sp];
    };
    // The scale is as large as the turned box allows.
    let half = [1e-9, 1e-9];
    for (let k = 0; k < 8; ++k) {
      const p = turned([0, 1, 2].map(i => (k >> i & 1 ? extent.high : extent.low)[i]));
      half = [Math.max(half[0], Math.abs(p[0])), Math.max(half[1], Math.abs(p[1]))];
    }
    const scale = zoom * Math.min((width / 2 - 70) / half[0], (height / 2 - 34) / half[1]);
    const project = p => { const q = turned(p); return [width / 2 + scale * q[0], height / 2 - scale * q[1], q[2]]; };

    for (const name of ['wetted', 'outer']) {
      const surface = data[name];
      if (!surface) continue;
      const painted = name === 'outer' && paint, see_through = name === 'outer' && data.wetted && !painted, faces = [], points = [];
      for (let i = 0; i < surface.vertices.length; i += 3) points.push(project(surface.vertices.slice(i, i + 3)));
      for (let f = 0; f < surface.quads.length; f += 4) {
        const q = [0, 1, 2, 3].map(k => points[surface.quads[f + k]]);
        const e1 = [0, 1, 2].map(k => (q[2][k] - q[0][k]) / (k < 2 ? scale : 1)), e2 = [0, 1, 2].map(k => (q[3][k] - q[1][k]) / (k < 2 ? scale : 1));
        const n = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]];
        const middle = painted ? [0, 1, 2].map(i => [0, 1, 2, 3].reduce((s, k) => s + surface.vertices[3 * surface.quads[f + k] + i] / 4, 0)) : null;
        faces.push({ q, colour: painted ? paint(middle) : surface_colours[name], depth: q.reduce((s, p) => s + p[2], 0), light: 0.62 + 0.38 * Math.abs(n[2]) / (Math.hypot(...n) || 1) });
      }
      faces.sort((a, b) => a.depth - b.depth);
      context.globalAlpha = see_through ? 0.35 : 1;
      for (const face of faces) {
        context.fillStyle = context.strokeStyle = rgb(face.colour.map(x => painted ? x * (0.6 + 0.4 * face.light) : 255 - (255 - x) / face.light * 0.8));
        context.lineWidth = 0.7;
        context.beginPath();
        face.q.forEach((p, k) => (k ? context.lineTo(p[0], p[1]) : context.moveTo(p[0], p[1])));
        context.closePath();
        context.fill();
        if (!see_through) context.stroke();
      }
      context.globalAlpha = name === 'outer' ? 0.9 : 0.6;
      context.strokeStyle = name === 'outer' ? '#57606a' : '#3b6d94';
      context.lineWidth = 1;
      context.beginPath();
      for (const e of lines[name]) {
        const a = project(e.slice(0, 3)), b = project(e.slice(3));
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
      }
      context.stroke();
      context.globalAlpha = 1;
    }
    context.lineWidth = 2;
    const places = data.sensors.map(s => {
      context.strokeStyle = s.colour ? '#333' : rgb(sensor_colour);
      context.fillStyle = rgb(s.colour || sensor_colour);
      const a = project(s.position), b = project(s.position.map((x, k) => x + s.direction[k] * extent.radius * 0.16));
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
      context.beginPath();
      context.arc(a[0], a[1], s.colour ? 6 : 4, 0, 2 * Math.PI);
      context.fill();
      if (s.colour) context.stroke();
      context.fillStyle = context.strokeStyle;
      if (length > 6) {
        const u = [(b[0] - a[0]) / length, (b[1] - a[1]) / length];
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.stroke();
        context.beginPath();
        context.moveTo(b[0] + 4 * u[0], b[1] + 4 * u[1]);
        context.lineTo(b[0] - 5 * u[0] - 4 * u[1], b[1] - 5 * u[1] + 4 * u[0]);
        context.lineTo(b[0] - 5 * u[0] + 4 * u[1], b[1] - 5 * u[1] - 4 * u[0]);
        context.fill();
      }
      return a;
    });
    labels(places);
  };
  let held = null;
  canvas.addEventListener('pointerdown', e => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
  canvas.addEventListener('pointerup', () => { held = null; });
  canvas.addEventListener('pointermove', e => {
    if (!held) return;
    turn -= 0.008 * (e.clientX - held[0]);
    tilt = Math.min(Math.max(tilt + 0.008 * (e.clientY - held[1]), -1.55), 1.55);
    held = [e.clientX, e.clientY];
    render();
  });
  canvas.addEventListener('wheel', e => { e.preventDefault(); zoom *= Math.exp(-0.001 * e.deltaY); render(); }, { passive: false });
  window.addEventListener('resize', render);
  render();
}
