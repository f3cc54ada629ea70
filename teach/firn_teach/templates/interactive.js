// SPDX-License-Identifier: BSD-3-Clause
// Drives web/exports.cpp: one session of the reference solver, stage by stage.
'use strict';

FirnWeb().then(firn => {
  const $ = id => document.getElementById(id);
  const stageCount = 10;
  const stageNames = [...document.querySelectorAll('#stages li')].map(li => li.textContent);
  const colliders = () => Number($('preset').value) === 0;

  // In the order of Parameter in web/session.hpp; `log`: the slider moves the logarithm.
  const parameters = [
    {name: 'E₀, Young’s modulus', unit: 'Pa', low: 1e4, high: 2e6, log: true},
    {name: 'ν, Poisson’s ratio', unit: '', low: 0, high: 0.45, step: 0.01},
    {name: 'ρ₀, density ○', unit: 'kg/m³', low: 100, high: 900, step: 10},
    {name: 'ξ, hardening', unit: '', low: 0, high: 30, step: 0.5},
    {name: 'θ_c, critical compression', unit: '', low: 0.002, high: 0.3, log: true},
    {name: 'θ_s, critical stretch', unit: '', low: 0.0005, high: 0.3, log: true},
    {name: 'α, share of FLIP', unit: '', low: 0, high: 1, step: 0.01},
    {name: 'β, implicitness (0: explicit)', unit: '', low: 0, high: 1, step: 0.05},
    {name: 'Δt', unit: 's', low: 2e-5, high: 5e-3, log: true},
    {name: 'g', unit: 'm/s²', low: 0, high: 30, step: 0.01},
    {name: 'μ, friction', unit: '', low: 0, high: 2, step: 0.05},
    {name: 'h, grid spacing ○', unit: 'm', low: 0.03, high: 0.06, step: 0.001},
    {name: 'speed at the start ○', unit: 'm/s', low: 0, high: 15, step: 0.1},
  ];

  function array(name) {
    const bytes = new TextEncoder().encode(name + '\0');
    const text = firn._malloc(bytes.length);
    firn.HEAPU8.set(bytes, text);
    const start = firn._firn_array(text) / 8;
    firn._free(text);
    return firn.HEAPF64.slice(start, start + firn._firn_array_size());
  }
  const vec = (a, k) => [a[3 * k], a[3 * k + 1], a[3 * k + 2]];
  const text = v => v.map(x => x.toPrecision(6)).join(', ');

  // --- state of the page -------------------------------------------------------------------
  let particle = 0;            // chosen, by index
  let node = [0, 0, 0];        // chosen, by (i,j,k)
  let running = false;
  let done = 0;                // stages of the step under way that are over
  let ledger;                  // where momentum came from since the restart
  let data;                    // arrays as they stand

  function read() {
    data = {};
    for (const name of ['x_p', 'v_p', 'strain', 'F_E', 'F_P', 'V_p0', 'm_p', 'node', 'm_i', 'v_i', 'f_i', 'v_star', 'v_new']) data[name] = array(name);
    const s = array('invariants');
    data.sums = {mass: s[0], momentum: [s[1], s[2], s[3]], kinetic: s[4], elastic: s[5], gravitational: s[6],
                 gridMass: s[7], gridMomentum: [s[8], s[9], s[10]], gridKinetic: s[11]};
  }
  const onGrid = () => done >= 1 && done < 8;
  const carried = () => onGrid() ? data.sums.gridMomentum : data.sums.momentum;

  function restart() {
    stop();
    firn._firn_restart();
    done = 0;
    read();
    particle = lowest();
    ledger = {start: carried().slice(), gravity: [0, 0, 0], solids: [0, 0, 0], scale: 0};
    $('failure').hidden = true;
    chooseNodeNear(vec(data.x_p, particle));
    show('Restarted.');
  }
  function lowest() {
    let best = 0;
    for (let p = 1; p < data.m_p.length; ++p) if (data.x_p[3 * p + 2] < data.x_p[3 * best + 2]) best = p;
    return best;
  }

  // --- stepping ----------------------------------------------------------------------------
  function advance() {
    const before = carried().slice();
    const stage = firn._firn_next_stage();
    const dt = firn._firn_get(8), g = firn._firn_get(9);
    if (!firn._firn_advance()) {
      stop();
      done = 0;
      read();
      $('failure').textContent = 'The step failed: ' + firn.UTF8ToString(firn._firn_error()) + '. The last good state is shown; try a shorter Δt, or β above 0.';
      $('failure').hidden = false;
      return false;
    }
    $('failure').hidden = true;
    done = stage;
    read();
    const after = carried();
    const change = after.map((x, k) => x - before[k]);
    ledger.scale = Math.max(ledger.scale, data.sums.mass * Math.sqrt(2 * data.sums.kinetic / data.sums.mass));
    if (stage === 4) ledger.gravity[2] -= data.sums.gridMass * g * dt;
    const contact = stage === 5 || stage === 9 || (stage === 6 && firn._firn_get(7) > 0 && colliders());
    if (contact) change.forEach((x, k) => { ledger.solids[k] += x; });
    return true;
  }
  function nextStage() { stop(); if (advance()) show(''); else show('Failed.'); }
  function finishStep() {
    do { if (!advance()) return false; } while (done < stageCount);
    return true;
  }
  function stop() {
    running = false;
    $('run').setAttribute('aria-pressed', 'false');
    $('run').firstChild.textContent = 'Run ';
  }
  function toggleRun() {
    if (running) { stop(); show('Paused.'); return; }
    running = true;
    $('run').setAttribute('aria-pressed', 'true');
    $('run').firstChild.textContent = 'Pause ';
    const frame = () => {
      if (!running) return;
      const good = finishStep();
      show(null);
      if (good) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  // --- drawing -----------------------------------------------------------------------------
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const viridis = ['#440154', '#482878', '#3e4a89', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];
  function colourOf(f) {
    const t = Math.min(Math.max(f, 0), 1) * (viridis.length - 1), k = Math.min(Math.floor(t), viridis.length - 2);
    const mix = [1, 3, 5].map(at => {
      const a = parseInt(viridis[k].substr(at, 2), 16), b = parseInt(viridis[k + 1].substr(at, 2), 16);
      return Math.round(a + (b - a) * (t - k));
    });
    return `rgb(${mix})`;
  }
  function view(canvas) {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio); }
    const c = canvas.getContext('2d');
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    const [x0, x1, z0] = colliders() ? [-0.27, 0.33, -0.09] : [-0.3, 0.3, -0.05];
    const scale = width / (x1 - x0);
    return {c, width, height, scale, at: x => [(x[0] - x0) * scale, height - (x[2] - z0) * scale], back: (px, py) => [px / scale + x0, 0, (height - py) / scale + z0]};
  }
  function arrow(v, from, d, colour) {
    const [x, y] = v.at(from), dx = d[0], dy = -d[2], size = Math.hypot(dx, dy);
    if (size < 0.5) return;
    v.c.strokeStyle = colour; v.c.lineWidth = 1.4; v.c.beginPath(); v.c.moveTo(x, y); v.c.lineTo(x + dx, y + dy);
    const head = Math.min(5, size / 2), a = Math.atan2(dy, dx);
    v.c.lineTo(x + dx - head * Math.cos(a - 0.5), y + dy - head * Math.sin(a - 0.5));
    v.c.moveTo(x + dx, y + dy);
    v.c.lineTo(x + dx - head * Math.cos(a + 0.5), y + dy - head * Math.sin(a + 0.5));
    v.c.stroke();
  }
  function ground(v) {
    if (!colliders()) return;
    const y = v.at([0, 0, 0.007])[1];
    v.c.fillStyle = css('--line');
    v.c.fillRect(0, y, v.width, v.height - y);
  }
  function ring(v, x, square) {
    const [px, py] = v.at(x);
    v.c.strokeStyle = css('--bad'); v.c.lineWidth = 2; v.c.beginPath();
    if (square) v.c.rect(px - 6, py - 6, 12, 12); else v.c.arc(px, py, 6.5, 0, 7);
    v.c.stroke();
  }
  function particleValues() {
    const what = $('colour').value, place = {J_E: 0, J_P: 1, smallest: 2, largest: 3}[what];
    return Float64Array.from(data.m_p, (_, p) => what === 'speed' ? Math.hypot(...vec(data.v_p, p)) : data.strain[4 * p + place]);
  }
  function drawParticles() {
    const v = view($('particles')), values = particleValues();
    ground(v);
    let low = Infinity, high = -Infinity;
    values.forEach(x => { low = Math.min(low, x); high = Math.max(high, x); });
    const span = high - low;
    for (let p = 0; p < values.length; ++p) {
      const [x, y] = v.at(vec(data.x_p, p));
      v.c.fillStyle = colourOf(span > 1e-9 * Math.abs(high) ? (values[p] - low) / span : 0.5);
      v.c.beginPath(); v.c.arc(x, y, 3, 0, 7); v.c.fill();
    }
    const h = firn._firn_get(11), first = vec(data.x_p, particle).map(x => Math.floor(x / h) - 1);
    const [a, b] = [v.at([first[0] * h, 0, (first[2] + 3) * h]), v.at([(first[0] + 3) * h, 0, first[2] * h])];
    v.c.strokeStyle = css('--muted'); v.c.lineWidth = 1; v.c.setLineDash([4, 3]); v.c.strokeRect(a[0], a[1], b[0] - a[0], b[1] - a[1]); v.c.setLineDash([]);
    ring(v, vec(data.x_p, particle));
    const name = $('colour').selectedOptions[0].textContent;
    $('particles-legend').textContent = `${name}: ${low.toPrecision(4)} (dark) to ${high.toPrecision(4)} (bright)${$('colour').value === 'speed' ? ' m/s' : ''}. Dashed: the reach of the chosen particle.`;
    $('particles').setAttribute('aria-label', `${values.length} particles seen from the side, coloured by ${name}, from ${low.toPrecision(4)} to ${high.toPrecision(4)}. Particle ${particle} is chosen.`);
  }
  function field() {
    const wanted = $('arrows').value;
    if (wanted !== 'newest') return wanted;
    return data.v_new.length ? 'v_new' : data.v_star.length ? 'v_star' : 'v_i';
  }
  function drawGrid() {
    const v = view($('grid')), h = firn._firn_get(11), name = field(), values = data[name], count = data.m_i.length;
    ground(v);
    let most = 0, longest = 0, shown = 0;
    const layer = [];
    for (let i = 0; i < count; ++i) {
      most = Math.max(most, data.m_i[i]);
      if (data.node[3 * i + 1] === node[1]) layer.push(i);
    }
    for (const i of layer) if (values.length) longest = Math.max(longest, Math.hypot(values[3 * i], values[3 * i + 2]));
    for (const i of layer) {
      const x = vec(data.node, i).map(n => n * h), [px, py] = v.at(x);
      v.c.fillStyle = css('--s2'); v.c.globalAlpha = 0.55;
      v.c.beginPath(); v.c.arc(px, py, Math.max(1.2, 10 * Math.sqrt(data.m_i[i] / most)), 0, 7); v.c.fill();
      v.c.globalAlpha = 1;
      if (values.length && longest > 0) { arrow(v, x, vec(values, i).map(d => d / longest * 1.5 * h * v.scale), css('--s1')); ++shown; }
    }
    ring(v, node.map(n => n * h), true);
    const unit = name === 'f_i' ? 'N' : 'm/s';
    $('grid-legend').textContent = count === 0 ? 'The grid is empty: stage 1 fills it.' :
      `Layer j = ${node[1]}, ${layer.length} of ${count} nodes. Area: mass, at most ${most.toPrecision(3)} kg. ` +
      (shown ? `Arrows: ${name}, the longest ${longest.toPrecision(3)} ${unit}.` : `${name} is not computed yet.`);
    $('grid').setAttribute('aria-label', `Grid nodes seen from the side. ${$('grid-legend').textContent} Node ${node.join(', ')} is chosen.`);
  }

  // --- choosing ----------------------------------------------------------------------------
  function nodeIndex() {
    for (let i = 0; i < data.m_i.length; ++i)
      if (node.every((n, k) => n === data.node[3 * i + k])) return i;
    return -1;
  }
  function chooseNodeNear(x) { const h = firn._firn_get(11); node = x.map(c => Math.round(c / h)); }
  function nearestParticle(point) {
    let best = 0, least = Infinity;
    for (let p = 0; p < data.m_p.length; ++p) {
      const d = Math.hypot(data.x_p[3 * p] - point[0], data.x_p[3 * p + 2] - point[2]);
      if (d < least) { least = d; best = p; }
    }
    return best;
  }
  function neighbour(dx, dz) {
    const from = vec(data.x_p, particle);
    let best = particle, least = Infinity;
    for (let p = 0; p < data.m_p.length; ++p) {
      const d = [data.x_p[3 * p] - from[0], data.x_p[3 * p + 2] - from[2]], along = d[0] * dx + d[1] * dz;
      if (p === particle || along <= 0 || along < 0.7 * Math.hypot(...d)) continue;
      if (Math.hypot(...d) < least) { least = Math.hypot(...d); best = p; }
    }
    return best;
  }
  const directions = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
  $('particles').addEventListener('keydown', event => {
    const d = directions[event.key];
    if (!d) return;
    event.preventDefault();
    particle = neighbour(...d);
    show(`Particle ${particle} chosen.`);
  });
  $('grid').addEventListener('keydown', event => {
    const d = directions[event.key], y = {PageUp: 1, PageDown: -1}[event.key] || 0;
    if (!d && !y) return;
    event.preventDefault();
    node = d ? [node[0] + d[0], node[1], node[2] + d[1]] : [node[0], node[1] + y, node[2]];
    show(`Node ${node.join(', ')} chosen.`);
  });
  function clicked(event) {
    const box = event.target.getBoundingClientRect();
    return view(event.target).back(event.clientX - box.left, event.clientY - box.top);
  }
  $('particles').addEventListener('click', event => { particle = nearestParticle(clicked(event)); show(`Particle ${particle} chosen.`); });
  $('grid').addEventListener('click', event => {
    const h = firn._firn_get(11), x = clicked(event);
    node = [Math.round(x[0] / h), node[1], Math.round(x[2] / h)];
    show(`Node ${node.join(', ')} chosen.`);
  });

  // --- numbers -----------------------------------------------------------------------------
  function rows(table, lines) {
    table.replaceChildren(...lines.map(([head, ...cells]) => {
      const tr = document.createElement('tr'), th = document.createElement('th');
      th.scope = 'row'; th.textContent = head; tr.append(th);
      for (const [value, name] of cells.map(c => Array.isArray(c) ? c : [c])) {
        const td = document.createElement('td');
        td.className = 'num'; td.textContent = value;
        if (name) td.dataset.invariant = name;
        tr.append(td);
      }
      return tr;
    }));
  }
  function showNumbers() {
    const p = particle, matrix = (a, k) => [0, 3, 6].map(r => text([...a.slice(9 * k + r, 9 * k + r + 3)])).join('\n');
    rows($('particle-numbers'), [
      ['particle', String(p)], ['x_p [m]', text(vec(data.x_p, p))], ['v_p [m/s]', text(vec(data.v_p, p))],
      ['m_p [kg]', data.m_p[p].toPrecision(6)], ['V_p0 [m³]', data.V_p0[p] > 0 ? data.V_p0[p].toPrecision(6) : 'not known yet'],
      ['F_E', matrix(data.F_E, p)], ['F_P', matrix(data.F_P, p)], ['J_E, J_P', text([data.strain[4 * p], data.strain[4 * p + 1]])]]);
    const i = nodeIndex(), at = (name, k) => !data.m_i.length ? '–' : i < 0 ? 'no mass' : data[name].length ? text(k === 3 ? vec(data[name], i) : [data[name][i]]) : 'not computed yet';
    rows($('node-numbers'), [['node (i, j, k)', node.join(', ')], ['m_i [kg]', at('m_i', 1)], ['v_i [m/s]', at('v_i', 3)], ['f_i [N]', at('f_i', 3)],
      ['v_i* [m/s]', at('v_star', 3)], ['v_i at n+1 [m/s]', at('v_new', 3)]]);
    const s = data.sums, now = carried(), fixed = x => x.toPrecision(12);
    const left = now.map((x, k) => x - ledger.start[k] - ledger.gravity[k] - ledger.solids[k]);
    const leftOver = Math.hypot(...left) / (ledger.scale || 1);
    rows($('invariants'), [
      ['', 'x', 'y', 'z'],
      [`momentum of the ${onGrid() ? 'grid' : 'particles'} [kg m/s]`, ...now.map((x, k) => [fixed(x), 'momentum-' + 'xyz'[k]])],
      ['at the restart', ...ledger.start.map(fixed)],
      ['from gravity', ...ledger.gravity.map(fixed)],
      ['from solids', ...ledger.solids.map(fixed)],
      ['left over', ...left.map(x => x.toExponential(2))],
      ['left over / Σ m |v|', [leftOver.toExponential(2), 'left-over']],
      ['mass of the particles [kg]', [String(s.mass), 'mass']],
      ['mass of the grid [kg]', [s.gridMass ? String(s.gridMass) : '–', 'grid-mass']],
      ['kinetic energy of the particles [J]', [fixed(s.kinetic), 'kinetic']],
      ['kinetic energy of the grid [J]', [s.gridMass ? fixed(s.gridKinetic) : '–', 'grid-kinetic']],
      ['elastic energy [J]', [fixed(s.elastic), 'elastic']],
      ['gravitational energy [J]', [fixed(s.gravitational), 'gravitational']],
      ['sum [J]', [fixed(s.kinetic + s.elastic + s.gravitational), 'energy']]]);
    $('hash').textContent = firn.UTF8ToString(firn._firn_hash());
  }

  function show(message) {
    drawParticles();
    drawGrid();
    showNumbers();
    const over = done % stageCount;
    document.querySelectorAll('#stages li').forEach((li, k) => {
      li.classList.toggle('done', k < done);
      if (k === over) li.setAttribute('aria-current', 'step'); else li.removeAttribute('aria-current');
    });
    const where = `Step ${firn._firn_steps()}, t = ${firn._firn_time().toPrecision(4)} s. ` + (done === 0 ? 'Before the step' : `Done: ${stageNames[done - 1]}`) + `; next: ${stageNames[over]}.`;
    // While it runs, a screen reader is spared sixty messages a second.
    $('status').setAttribute('aria-live', message === null ? 'off' : 'polite');
    $('status').textContent = message ? `${message} ${where}` : where;
  }

  // --- controls ----------------------------------------------------------------------------
  const sliders = parameters.map((parameter, k) => {
    const label = document.createElement('label'), name = document.createElement('span'), output = document.createElement('output'), input = document.createElement('input');
    const to = x => parameter.log ? Math.log10(x) : x, from = x => parameter.log ? Number((10 ** x).toPrecision(3)) : x;
    name.textContent = parameter.name;
    Object.assign(input, {type: 'range', id: `parameter-${k}`, min: to(parameter.low), max: to(parameter.high), step: parameter.log ? 0.01 : parameter.step});
    const write = () => {
      const shown = `${Number(firn._firn_get(k).toPrecision(4))} ${parameter.unit}`.trim();
      output.textContent = shown;
      input.setAttribute('aria-valuetext', shown);
    };
    input.addEventListener('input', () => { firn._firn_set(k, from(Number(input.value))); write(); });
    label.append(name, output, input);
    $('sliders').append(label);
    return () => { input.value = to(firn._firn_get(k)); write(); };
  });
  function start() {
    firn._firn_start(Number($('preset').value));
    sliders.forEach(refresh => refresh());
    restart();
  }
  $('next').addEventListener('click', nextStage);
  $('step').addEventListener('click', () => { stop(); finishStep(); show(''); });
  $('run').addEventListener('click', toggleRun);
  $('restart').addEventListener('click', restart);
  $('defaults').addEventListener('click', start);
  $('preset').addEventListener('change', start);
  $('colour').addEventListener('change', drawParticles);
  $('arrows').addEventListener('change', drawGrid);
  document.addEventListener('keydown', event => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches('select')) return;
    const button = {n: 'next', s: 'step', p: 'run', r: 'restart'}[event.key.toLowerCase()];
    if (button) { event.preventDefault(); $(button).click(); }
  });
  window.addEventListener('resize', () => { drawParticles(); drawGrid(); });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { drawParticles(); drawGrid(); });
  $('app').hidden = false;
  start();
});
