"use strict";
// The scene in three dimensions: cables coloured by their tension, points, ground, water, winds and traces, at any time.

// Numbers of an array that Python packed: base64 of little-endian float32.
function unpack(text) {
  return new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
}

// Number of the last time that is not after t, and how far t is on the way to the next one, from 0 to 1.
function place(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const span = times[high] - times[low];
  return [low, span > 0 ? Math.min(1, Math.max(0, (t - times[low]) / span)) : 0];
}

// Text of a number with three digits.
function short(x) {
  return x === 0 ? "0" : Math.abs(x) >= 1e4 || Math.abs(x) < 1e-3 ? x.toExponential(1) : String(Number(x.toPrecision(3)));
}

// 1, 2 or 5 times a power of ten, not above x.
function round(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return power * (x / power >= 5 ? 5 : x / power >= 2 ? 2 : 1);
}

// Red, green and blue (0 to 1) of a tension's share of the full scale.
function colourScale(colours) {
  const rows = colours.map((c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16) / 255));
  return (share, into, at) => {
    const x = Math.min(1, Math.max(0, share)) * (rows.length - 1), i = Math.min(rows.length - 2, Math.floor(x));
    for (let k = 0; k < 3; k++) into[at + k] = rows[i][k] + (x - i) * (rows[i + 1][k] - rows[i][k]);
  };
}

function makeStage(content, element) {
  const { Vector3 } = THREE;
  const times = unpack(content.states.t), q = unpack(content.states.q), tension = unpack(content.states.tension);
  const nodes = q.length / 3 / times.length, segments = content.ends.length, now = new Float32Array(3 * nodes);
  const low = new Vector3(...content.box[0]), high = new Vector3(...content.box[1]);
  const diagonal = Math.max(high.distanceTo(low), 1e-9), size = Math.min(content.size, diagonal);

  THREE.ColorManagement.enabled = false;
  const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
  renderer.domElement.className = "drawing";
  element.prepend(renderer.domElement);
  const scene = new THREE.Scene(), along = new THREE.Group(); // what goes along with the structure
  scene.add(along, new THREE.AmbientLight(0xffffff, 2.2));
  const sun = new THREE.DirectionalLight(0xffffff, 1.6);
  sun.position.set(-1, -2, 3);
  scene.add(sun);
  const camera = new THREE.PerspectiveCamera(32, 1, 1e-3 * size, 1e3 * diagonal);
  camera.up.set(0, 0, 1);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.zoomSpeed = 1.5;

  // --- cables -------------------------------------------------------------------------------------------------------------

  const geometry = new THREE.LineSegmentsGeometry();
  geometry.setPositions(new Float32Array(6 * segments));
  geometry.setColors(new Float32Array(6 * segments));
  const cables = new THREE.LineSegments2(geometry, new THREE.LineMaterial({ vertexColors: true, linewidth: 3.2 }));
  cables.frustumCulled = false;
  scene.add(cables);
  const ends = geometry.attributes.instanceStart.data, tints = geometry.attributes.instanceColorStart.data;
  const scale = colourScale(content.colours.tension), slack = new Float32Array(3);
  colourScale([content.colours.slack, content.colours.slack])(0, slack, 0);
  const least = 1e-6 * content.full_scale;

  function drawCables(t, i, f) {
    let m = 0;
    for (let s = 0; s < segments; s++) {
      const broken = content.broken_at[s];
      if (broken !== null && t > broken) continue;
      const [a, b] = content.ends[s], first = tension[i * segments + s];
      const T = f > 0 ? first + f * (tension[(i + 1) * segments + s] - first) : first;
      const taut = T > least, from = taut ? 0 : 0.22; // of a slack segment the middle is drawn, so that a slack cable is dashed
      for (let k = 0; k < 3; k++) {
        const x = now[3 * a + k], d = now[3 * b + k] - x;
        ends.array[6 * m + k] = x + from * d;
        ends.array[6 * m + 3 + k] = x + (1 - from) * d;
        if (!taut) tints.array[6 * m + k] = slack[k];
      }
      if (taut) scale(T / content.full_scale, tints.array, 6 * m);
      tints.array.copyWithin(6 * m + 3, 6 * m, 6 * m + 3);
      m += 1;
    }
    geometry.instanceCount = m;
    ends.needsUpdate = tints.needsUpdate = true;
  }

  // --- points and their names ---------------------------------------------------------------------------------------------

  const labels = document.getElementById("labels"), named = [];
  const radius = 0.017 * size;
  const ball = new THREE.SphereGeometry(radius, 20, 14), box = new THREE.BoxGeometry(1.7 * radius, 1.7 * radius, 1.7 * radius);
  for (const point of content.points) {
    const material = new THREE.MeshLambertMaterial({ color: content.colours.points[point.kind] });
    const mesh = new THREE.Mesh(point.kind === "fixed" ? box : ball, material);
    scene.add(mesh);
    named.push({ text: label(point.name, ""), at: mesh.position, node: point.node, flow: false });
  }

  function label(text, kind) {
    const span = document.createElement("span");
    span.textContent = text;
    span.className = kind;
    labels.append(span);
    return span;
  }

  // --- bodies -------------------------------------------------------------------------------------------------------------

  const poses = content.bodies.length ? unpack(content.states.bodies) : null, before = new THREE.Quaternion(), after = new THREE.Quaternion();
  const boxes = content.bodies.map((body) => {
    const material = new THREE.MeshLambertMaterial({ color: content.colours.body, transparent: true, opacity: 0.85 });
    const mesh = new THREE.Mesh(new THREE.BoxGeometry(...body.sides), material);
    scene.add(mesh);
    named.push({ text: label(body.name, ""), at: mesh.position, flow: false, node: null });
    return mesh;
  });

  function drawBodies(i, f) {
    boxes.forEach((mesh, b) => {
      const first = 7 * (i * boxes.length + b), next = f > 0 ? first + 7 * boxes.length : first;
      for (let k = 0; k < 3; k++) mesh.position.setComponent(k, poses[first + k] + f * (poses[next + k] - poses[first + k]));
      before.fromArray(poses, first + 3);
      after.fromArray(poses, next + 3);
      mesh.quaternion.copy(before.slerp(after, f));
    });
  }

  // --- traces of the free points ------------------------------------------------------------------------------------------

  function thin(positions) {
    const line = new THREE.BufferGeometry();
    line.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    const object = new THREE.Line(line, new THREE.LineBasicMaterial({ color: content.colours.points.free, transparent: true, opacity: 0.75 }));
    object.frustumCulled = false;
    scene.add(object);
    return object;
  }

  const traces = content.points.filter((point) => point.kind === "free").map((point) => {
    const past = new Float32Array(3 * times.length);
    for (let i = 0; i < times.length; i++) for (let k = 0; k < 3; k++) past[3 * i + k] = q[3 * (i * nodes + point.node) + k];
    return { past: thin(past), rest: thin(new Float32Array(6)), node: point.node };
  });

  // All states up to the i-th, and from there to where the point is now.
  function drawTraces(i) {
    for (const { past, rest, node } of traces) {
      past.geometry.setDrawRange(0, i + 1);
      const ends = rest.geometry.attributes.position;
      for (let k = 0; k < 3; k++) {
        ends.array[k] = q[3 * (i * nodes + node) + k];
        ends.array[3 + k] = now[3 * node + k];
      }
      ends.needsUpdate = true;
    }
  }

  // --- ground, water, winds -----------------------------------------------------------------------------------------------

  const { ground, water, wave, flows } = content.around;
  const width = 1.3 * Math.max(high.x - low.x, high.y - low.y, size), middle = new Vector3().addVectors(low, high).multiplyScalar(0.5);
  const mesh = round(width / (content.follow ? Math.min(60, width / (0.5 * size)) : 8)), half = Math.ceil(width / 2 / mesh) * mesh;

  // Turned so that its z points along a normal, and put where the vertical through a place meets its plane.
  function lay(object, plane, over) {
    const normal = new Vector3(...plane.normal);
    object.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), normal);
    const gap = plane.height - normal.dot(over);
    object.position.copy(over).addScaledVector(normal, gap);
  }

  function grid(colour, opacity) {
    const lines = [];
    for (let x = -half; x < half + mesh / 2; x += mesh) lines.push(x, -half, 0, x, half, 0, -half, x, 0, half, x, 0);
    const made = new THREE.BufferGeometry();
    made.setAttribute("position", new THREE.BufferAttribute(new Float32Array(lines), 3));
    return new THREE.LineSegments(made, new THREE.LineBasicMaterial({ color: colour, transparent: true, opacity }));
  }

  function sheet(colour, opacity, parts) {
    const material = new THREE.MeshLambertMaterial({ color: colour, transparent: true, opacity, side: THREE.DoubleSide, depthWrite: false });
    return new THREE.Mesh(new THREE.PlaneGeometry(2 * half, 2 * half, parts, parts), material);
  }

  const floor = ground || { normal: [0, 0, 1], height: low.z - 0.06 * size };
  const net = grid(ground ? content.colours.ground : "#7d8a92", ground ? 0.55 : 0.28);
  lay(net, floor, middle);
  scene.add(net);
  if (ground) {
    const soil = sheet(content.colours.ground, 0.3, 1);
    lay(soil, floor, middle);
    scene.add(soil);
  }
  const sea = water && sheet(content.colours.water, 0.28, wave ? 64 : 1);
  if (sea) {
    lay(sea, water, middle);
    scene.add(sea);
  }
  for (const solid of content.around.obstacles) {
    const centre = new Vector3(...solid.at), turn = new THREE.Quaternion(...solid.turn), axis = new Vector3(0, 0, 1).applyQuaternion(turn);
    let [x, y, z] = solid.widths, shape;
    if (z === null) { // a cylinder without ends: the part of it that is near
      z = 2 * half;
      centre.addScaledVector(axis, middle.clone().sub(centre).dot(axis));
    }
    if (solid.kind === "sphere") shape = new THREE.SphereGeometry(x / 2, 40, 24);
    else if (solid.kind === "cylinder") shape = new THREE.CylinderGeometry(x / 2, x / 2, z, 48).rotateX(Math.PI / 2);
    else shape = new THREE.BoxGeometry(x, y, z);
    const mesh = new THREE.Mesh(shape, new THREE.MeshLambertMaterial({ color: content.colours.obstacle, transparent: true, opacity: 0.55 }));
    mesh.position.copy(centre);
    mesh.quaternion.copy(turn);
    scene.add(mesh);
  }
  const length = wave ? (2 * Math.PI) / wave.k : 0;
  document.getElementById("grid").textContent = `${ground ? "ground" : "grid (no ground)"}: ${short(mesh)} m a square`;

  function drawWave(t) {
    if (!wave || length < half / 16) return; // a shorter wave is no surface on this mesh
    const at = sea.geometry.attributes.position, s = wave.ramp > 0 ? Math.min(1, Math.max(0, t / wave.ramp)) : 1;
    const share = s * s * s * (10 + s * (6 * s - 15));
    for (let i = 0; i < at.count; i++) {
      const along = wave.direction[0] * (at.getX(i) + sea.position.x) + wave.direction[1] * (at.getY(i) + sea.position.y);
      at.setZ(i, share * wave.amplitude * Math.cos(wave.k * along - wave.frequency * t + wave.phase));
    }
    at.needsUpdate = true;
    sea.geometry.computeVertexNormals();
  }

  const shown = content.follow ? size : diagonal;
  flows.forEach((flow, i) => {
    const way = new Vector3(...flow.velocity).normalize(), long = 0.22 * shown, arrow = new THREE.Group();
    const material = new THREE.MeshLambertMaterial({ color: content.colours[flow.name] });
    const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.018 * long, 0.018 * long, 0.76 * long, 12), material);
    const head = new THREE.Mesh(new THREE.ConeGeometry(0.07 * long, 0.24 * long, 20), material);
    shaft.position.y = 0.38 * long;
    head.position.y = 0.88 * long;
    arrow.add(shaft, head);
    arrow.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way);
    const from = flow.name === "wind" ? new Vector3(low.x, low.y, high.z + 0.12 * shown) : new Vector3(low.x, low.y, low.z + 0.12 * shown);
    if (content.follow) from.copy(start()).add(new Vector3(-0.6 * size, -0.6 * size, (0.5 - 0.6 * i) * size));
    arrow.position.copy(from);
    along.add(arrow);
    named.push({ text: label(flow.text, "flow"), at: from.clone().addScaledVector(way, 0.5 * long), flow: true });
  });

  // --- the camera ---------------------------------------------------------------------------------------------------------

  function centre(of, at) {
    const mean = new Vector3();
    for (let n = 0; n < nodes; n++) mean.add(new Vector3(of[at + 3 * n], of[at + 3 * n + 1], of[at + 3 * n + 2]));
    return mean.divideScalar(nodes);
  }

  function start() {
    return centre(q, 0);
  }

  // Part of the width that the legend covers.
  function legendShare() {
    return Math.min(0.4, (document.getElementById("legend").offsetWidth + 12) / element.clientWidth);
  }

  // As near as a box of corners, seen from before and above, is in the picture as a whole.
  function fit() {
    const far = high.y - low.y > 1.5 * (high.x - low.x), towards = new Vector3(far ? 1.7 : 0.6, far ? -0.6 : -1.7, 0.55).normalize();
    let [a, b] = [low.clone(), high.clone()];
    if (following) {
      const here = centre(now, 0), reach = new Vector3(size, size, size).multiplyScalar(0.62);
      [a, b] = [here.clone().sub(reach), here.clone().add(reach)];
    } else {
      for (const plane of [ground, water]) { // a ground or a surface that is near belongs to the picture
        if (plane && Math.abs(plane.height - middle.z * plane.normal[2]) < diagonal) {
          a.z = Math.min(a.z, plane.height);
          b.z = Math.max(b.z, plane.height);
        }
      }
      if (flows.length) b.z += 0.14 * shown;
    }
    controls.target.addVectors(a, b).multiplyScalar(0.5);
    const right = new Vector3().crossVectors(new Vector3(0, 0, 1), towards).normalize(), top = new Vector3().crossVectors(towards, right);
    const y = Math.tan((camera.fov * Math.PI) / 360), x = y * camera.aspect * (1 - legendShare());
    let distance = 0;
    for (let c = 0; c < 8; c++) {
      const d = new Vector3(c & 1 ? a.x : b.x, c & 2 ? a.y : b.y, c & 4 ? a.z : b.z).sub(controls.target);
      distance = Math.max(distance, d.dot(towards) + Math.max(Math.abs(d.dot(right)) / x, Math.abs(d.dot(top)) / y));
    }
    camera.position.copy(controls.target).addScaledVector(towards, Math.max(1.15 * distance, 0.5 * size));
    controls.update();
  }

  let following = content.follow, last = start();

  function go() {
    const here = centre(now, 0), step = here.clone().sub(last);
    if (following) {
      camera.position.add(step);
      controls.target.add(step);
      along.position.add(step);
    }
    last = here;
  }

  function drawLabels(names) {
    const spot = new Vector3(), [w, h] = [element.clientWidth, element.clientHeight];
    for (const one of named) {
      spot.copy(one.at);
      if (one.flow) spot.add(along.position);
      spot.project(camera);
      const seen = (names || one.flow) && Math.abs(spot.z) < 1;
      one.text.style.display = seen ? "" : "none";
      one.text.style.transform = `translate(${(0.5 + 0.5 * spot.x) * w + 9}px, ${(0.5 - 0.5 * spot.y) * h - 18}px)`;
    }
  }

  // Where x, y and z point, in a corner.
  function drawAxes() {
    const pen = document.getElementById("axes").getContext("2d"), turn = camera.quaternion.clone().invert();
    pen.setTransform(2, 0, 0, 2, 88, 88);
    pen.clearRect(-44, -44, 88, 88);
    pen.font = "600 12px Arial, sans-serif";
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.lineWidth = 2;
    for (const [name, x, y, z, colour] of [["x", 1, 0, 0, "#b2452f"], ["y", 0, 1, 0, "#2c7a4b"], ["z", 0, 0, 1, "#1f5f8b"]]) {
      const d = new Vector3(x, y, z).applyQuaternion(turn);
      pen.strokeStyle = pen.fillStyle = colour;
      pen.beginPath();
      pen.moveTo(0, 0);
      pen.lineTo(26 * d.x, -26 * d.y);
      pen.stroke();
      pen.fillText(name, 35 * d.x, -35 * d.y);
    }
  }

  const options = { names: true, traces: true };

  function draw() {
    controls.update();
    for (const { past, rest } of traces) past.visible = rest.visible = options.traces;
    renderer.render(scene, camera);
    drawLabels(options.names);
    drawAxes();
  }

  // The scene at a time t [s].
  function show(t) {
    const [i, f] = place(times, t);
    for (let x = 0; x < now.length; x++) {
      const first = q[i * now.length + x];
      now[x] = f > 0 ? first + f * (q[(i + 1) * now.length + x] - first) : first;
    }
    drawCables(t, i, f);
    for (const one of named) if (!one.flow && one.node !== null) one.at.fromArray(now, 3 * one.node);
    drawBodies(i, f);
    drawTraces(i);
    drawWave(t);
    go();
    draw();
  }

  function resize() {
    renderer.setSize(element.clientWidth, element.clientHeight);
    camera.aspect = element.clientWidth / element.clientHeight;
    const [w, h] = [element.clientWidth, element.clientHeight]; // the middle of the picture is that of what the legend leaves
    camera.setViewOffset(w, h, 0.5 * legendShare() * w, 0, w, h);
    camera.updateProjectionMatrix();
  }

  function follow(on) {
    following = on;
    fit();
  }

  controls.addEventListener("change", () => requestAnimationFrame(draw));
  return { times, show, draw, fit, follow, resize, options };
}
