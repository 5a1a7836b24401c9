// What the explorer of a report takes from its libraries, under one global name.
import uPlot from "uplot";
import {
  AmbientLight, ArrowHelper, AxesHelper, BufferAttribute, BufferGeometry, Color, DirectionalLight,
  Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial,
  PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";

globalThis.explorerLibraries = {
  uPlot,
  three: {
    AmbientLight, ArrowHelper, AxesHelper, BufferAttribute, BufferGeometry, Color, DirectionalLight,
    Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshLambertMaterial,
    PerspectiveCamera, Points, PointsMaterial, Quaternion, Scene, Vector3, WebGLRenderer,
    OrbitControls, GLTFLoader,
  },
};
