// The scene: obstacles, robot, floor and camera. World coordinates, z up. makeView() gives a
// function that shows the robot at a time. Draws on demand: a page at rest costs nothing.

const LINK_COLORS = [0x0072b2, 0x56b4e9];  // by turns; the base is grey
const BASE_COLOR = 0x8592a3;
const START_COLOR = 0x009e73;
const GOAL_COLOR = 0xd55e00;
const AXIS_COLORS = [0xc62828, 0x2e7d32, 0x1565c0];

function placed(geometry, material, position, axes) {
  const mesh = new THREE.Mesh(geometry, material);
  if (axes) mesh.quaternion.set(...axes);
  mesh.position.set(...position);
  return mesh;
}

// three.js stands cylinders and capsules along y; ours are along z.
function upright(geometry) { return geometry.rotateX(Math.PI / 2); }

function obstacleMesh(obstacle, material) {
  const { type, position, quaternion_xyzw: axes, size, radius, height, vertices } = obstacle;
  if (type === 'box') return placed(new THREE.BoxGeometry(...size), material, position, axes);
  if (type === 'cylinder') {
    const geometry = upright(new THREE.CylinderGeometry(radius, radius, height, 48));
    return placed(geometry, material, position, axes);
  }
  if (type === 'capsule') {
    const geometry = upright(new THREE.CapsuleGeometry(radius, height, 12, 32));
    return placed(geometry, material, position, axes);
  }
  const points = vertices.map((v) => new THREE.Vector3(...v));
  return new THREE.Mesh(new THREE.ConvexGeometry(points), material);
}

const linkColor = (link) =>
  link === 0 && !data.is_flat ? BASE_COLOR : LINK_COLORS[link % LINK_COLORS.length];

// The robot's capsules, in one colour or by link, as meshes that `place` moves; ends in a frame lie
// six numbers apart.
function makeRobot(first, opacity, oneColor) {
  const group = new THREE.Group();
  for (const [i, capsule] of data.capsules.entries()) {
    const radius = Math.max(capsule.radius, (data.is_flat ? 6e-3 : 1e-3) * extent.size);
    const ends = first.slice(6 * i, 6 * i + 6);
    const length = Math.hypot(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]);
    const geometry = data.is_flat && length === 0
      ? upright(new THREE.CylinderGeometry(radius, radius, 0.02 * extent.size, 48))
      : upright(new THREE.CapsuleGeometry(radius, length, 10, 24));
    const color = oneColor === undefined ? linkColor(capsule.link) : oneColor;
    const material = new THREE.MeshLambertMaterial(
      { color, transparent: opacity < 1, opacity, depthWrite: opacity === 1,
        polygonOffset: opacity < 1, polygonOffsetFactor: 2, polygonOffsetUnits: 2 });
    group.add(new THREE.Mesh(geometry, material));
  }
  place(group, (i) => first[i]);
  return group;
}

const UP = () => new THREE.Vector3(0, 0, 1);

function pose(robot, t) {
  const { low, high, share } = locate(t);
  const a = data.frames[low];
  const b = data.frames[high];
  place(robot, (i) => a[i] + share * (b[i] - a[i]));
}

// at(i): number i of a frame.
function place(robot, at) {
  for (const [i, mesh] of robot.children.entries()) {
    const p0 = new THREE.Vector3(at(6 * i), at(6 * i + 1), at(6 * i + 2));
    const p1 = new THREE.Vector3(at(6 * i + 3), at(6 * i + 4), at(6 * i + 5));
    mesh.position.copy(p0).add(p1).multiplyScalar(0.5);
    const along = p1.sub(p0);
    if (along.length() > 0) mesh.quaternion.setFromUnitVectors(UP(), along.normalize());
  }
}

// Of an obstacle, or of a box around it in its own axes.
function cornersOf({ type, position, quaternion_xyzw: axes, size, radius, height, vertices }) {
  if (type === 'hull') return vertices;
  const end = height / 2 + (type === 'capsule' ? radius : 0);
  const half = type === 'box' ? size.map((s) => s / 2) : [radius, radius, end];
  const turn = new THREE.Quaternion(...axes);
  return [...Array(8).keys()].map((bits) => {
    const corner = half.map((h, k) => (bits >> k) & 1 ? h : -h);
    return new THREE.Vector3(...corner).applyQuaternion(turn).toArray()
      .map((v, k) => v + position[k]);
  });
}

// Middle and size of what is shown: the bounds of a flat world, else the robot's motion and the
// obstacles.
function findExtent() {
  const points = [];
  if (data.bounds) {
    points.push([data.bounds[0], data.bounds[1], 0], [data.bounds[2], data.bounds[3], 0]);
  } else {
    for (const frame of [data.start, data.goal, ...data.frames]) {
      for (let i = 0; i < frame.length; i += 3) points.push(frame.slice(i, i + 3));
    }
    for (const obstacle of data.obstacles) points.push(...cornersOf(obstacle));
  }
  if (points.length === 0) points.push([-1, -1, -1], [1, 1, 1]);
  const lower = [0, 1, 2].map((k) => points.reduce((m, p) => Math.min(m, p[k]), Infinity));
  const upper = [0, 1, 2].map((k) => points.reduce((m, p) => Math.max(m, p[k]), -Infinity));
  const sides = upper.map((u, k) => u - lower[k]);
  return { points, middle: lower.map((l, k) => l + sides[k] / 2), lower, sides,
           size: Math.max(Math.hypot(...sides), 0.1) };
}

function makeCamera() {
  if (!data.is_flat) {
    const camera = new THREE.PerspectiveCamera(45, 1, 0.01 * extent.size, 50 * extent.size);
    camera.up.set(0, 0, 1);
    return camera;
  }
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.01 * extent.size, 50 * extent.size);
  camera.up.set(0, 1, 0);
  camera.position.set(extent.middle[0], extent.middle[1], 2 * extent.size);
  return camera;
}

// As near as shows everything, from +x -y above. Returns what the camera looks at.
function approach(camera) {
  const [first, last] = [floor.lines[0], floor.lines[floor.lines.length - 1]];
  const points = [...extent.points, first, last, [first[0], last[1], first[2]],
                  [last[0], first[1], first[2]],
                  ...floor.axes.map((axis) => axis[1])].map((p) => new THREE.Vector3(...p));
  const target = new THREE.Vector3(...extent.middle);
  const direction = new THREE.Vector3(0.62, -0.85, 0.45).normalize();
  const lookFrom = (distance) => {
    camera.position.copy(direction).multiplyScalar(distance * extent.size).add(target);
    camera.lookAt(target);
    camera.updateMatrixWorld();
    return points.map((point) => point.clone().project(camera));
  };
  const fits = (seen) => seen.every((p) => Math.max(Math.abs(p.x), Math.abs(p.y)) < 0.88);
  for (let round = 0; round < 3; ++round) {
    let distance = 0.4;
    while (distance < 8 && !fits(lookFrom(distance))) distance *= 1.05;
    const seen = lookFrom(distance);
    const middle = ['x', 'y'].map((k) => seen.reduce((m, p) => Math.min(m, p[k]), 1) / 2 +
                                         seen.reduce((m, p) => Math.max(m, p[k]), -1) / 2);
    target.set(...middle, target.clone().project(camera).z).unproject(camera);
    lookFrom(distance);
  }
  return target;
}

function polyline(points, color, Kind) {
  const geometry = new THREE.BufferGeometry().setFromPoints(
    points.map((p) => new THREE.Vector3(...p)));
  return new Kind(geometry, new THREE.LineBasicMaterial({ color }));
}

function makeScene() {
  const scene = new THREE.Scene();
  scene.add(new THREE.AmbientLight(0xffffff, 1.6));
  const sun = new THREE.DirectionalLight(0xffffff, 1.8);
  sun.position.set(1, -2, 4);
  scene.add(sun);
  for (const obstacle of data.obstacles) {
    scene.add(obstacleMesh(obstacle, new THREE.MeshLambertMaterial(
      { color: obstacle.culprit ? 0xc62828 : 0xa3acb8, transparent: !data.is_flat,
        opacity: data.is_flat ? 1 : 0.65 })));
  }
  if (data.bounds) {
    const [x0, y0, x1, y1] = data.bounds;
    scene.add(polyline([[x0, y0, 0], [x1, y0, 0], [x1, y1, 0], [x0, y1, 0]], 0x1f2933,
                       THREE.LineLoop));
  } else {
    scene.add(polyline(floor.lines, 0xdde2e8, THREE.LineSegments));
    for (const [i, axis] of floor.axes.entries()) {
      scene.add(polyline(axis, AXIS_COLORS[i], THREE.Line));
    }
  }
  if (data.tool_path.length > 1) scene.add(polyline(data.tool_path, 0x1f2933, THREE.Line));
  return scene;
}

// A grid below everything whose lines lie on round numbers, and arrows along it from its corner.
function makeFloor() {
  const cell = niceStep(Math.max(...extent.sides, 0.1) / 14);
  const z = Math.floor(extent.lower[2] / cell) * cell;
  const low = [0, 1].map((k) => Math.floor(extent.lower[k] / cell));
  const high = [0, 1].map((k) => Math.ceil((extent.lower[k] + extent.sides[k]) / cell));
  const lines = [];
  for (let i = low[0]; i <= high[0]; ++i) {
    lines.push([i * cell, low[1] * cell, z], [i * cell, high[1] * cell, z]);
  }
  for (let i = low[1]; i <= high[1]; ++i) {
    lines.push([low[0] * cell, i * cell, z], [high[0] * cell, i * cell, z]);
  }
  const corner = [low[0] * cell, low[1] * cell, z];
  const axes = [0, 1, 2].map((k) => [corner, corner.map((v, m) => v + (m === k ? 2 * cell : 0))]);
  return { cell, lines, axes };
}

const extent = findExtent();
const floor = data.is_flat ? null : makeFloor();

// Letters at the ends of the axes, put where the camera sees them.
function makeAxisLabels(view, camera) {
  if (data.is_flat) return () => {};
  const labels = floor.axes.map((axis, i) => {
    const label = document.createElement('span');
    label.className = 'axis';
    label.textContent = 'xyz'[i];
    label.style.color = `#${AXIS_COLORS[i].toString(16).padStart(6, '0')}`;
    view.append(label);
    return { label, end: new THREE.Vector3(...axis[1]) };
  });
  return () => {
    for (const { label, end } of labels) {
      const p = end.clone().project(camera);
      label.style.left = `${50 * (p.x + 1)}%`;
      label.style.top = `${50 * (1 - p.y)}%`;
      label.hidden = Math.abs(p.z) > 1;
    }
  };
}

function addKey() {
  const entries = [['start', START_COLOR], ['goal', GOAL_COLOR]];
  if (data.frames.length > 0) {
    entries.push(['robot', LINK_COLORS[0]], [data.is_flat ? 'path' : "tool's path", 0x1f2933]);
  }
  for (const [name, color] of entries) {
    const entry = document.createElement('span');
    entry.textContent = name;
    entry.style.borderColor = `#${color.toString(16).padStart(6, '0')}`;
    element('key').append(entry);
  }
  const scale = document.createElement('em');
  const [width, height] = extent.sides.map((side) => Number(side.toPrecision(4)));
  scale.textContent = data.is_flat
    ? `${width} m x ${height} m; wheel: zoom`
    : `grid ${Number(floor.cell.toPrecision(2))} m; drag: turn, wheel: zoom`;
  element('key').append(scale);
}

function makeView() {
  const view = element('view');
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setClearColor(0xffffff);
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  view.appendChild(renderer.domElement);
  const scene = makeScene();
  const camera = makeCamera();
  const controls = new THREE.OrbitControls(camera, renderer.domElement);
  controls.target.set(...extent.middle);
  controls.enableRotate = !data.is_flat;
  controls.update();
  const opacity = data.frames.length > 0 ? 0.35 : 0.9;
  scene.add(makeRobot(data.start, opacity, START_COLOR), makeRobot(data.goal, opacity, GOAL_COLOR));
  const robot = data.frames.length > 0 ? makeRobot(data.frames[0], 1) : new THREE.Group();
  scene.add(robot);
  const placeLabels = makeAxisLabels(view, camera);
  const draw = () => {
    renderer.render(scene, camera);
    placeLabels();
  };
  let hasApproached = false;
  const resize = () => {
    const { clientWidth: width, clientHeight: height } = view;
    const aspect = width / Math.max(1, height);
    renderer.setSize(width, height);
    if (data.is_flat) {
      const half = 0.55 * Math.max(extent.sides[1], extent.sides[0] / aspect);
      Object.assign(camera, { left: -half * aspect, right: half * aspect, top: half,
                              bottom: -half });
    } else {
      camera.aspect = aspect;
    }
    camera.updateProjectionMatrix();
    if (!data.is_flat && !hasApproached) {
      controls.target.copy(approach(camera));
      controls.update();
    }
    hasApproached = true;
    draw();
  };
  controls.addEventListener('change', draw);
  window.addEventListener('resize', resize);
  resize();
  addKey();
  return (t) => {
    if (data.frames.length > 0) pose(robot, t);
    draw();
  };
}
