// What viewer.js uses of three.js: the entry of the bundle three.min.js, see README.md.
export {
  AmbientLight, BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, DirectionalLight,
  Group, Line, LineBasicMaterial, LineLoop, LineSegments, Mesh, MeshLambertMaterial,
  OrthographicCamera, PerspectiveCamera, Quaternion, Scene, Vector3, WebGLRenderer
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
export { ConvexGeometry } from 'three/addons/geometries/ConvexGeometry.js';
