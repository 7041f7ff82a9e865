// For tests in node: the page's TypeScript, and the bundled buildings.
import {mkdtempSync, readFileSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {fileURLToPath, pathToFileURL} from 'node:url';

export const inspector = fileURLToPath(new URL('../../../service/inspector/', import.meta.url));
const require = createRequire(join(inspector, 'package.json'));
const esbuild = createRequire(require.resolve('vite'))('esbuild');

/** An npm package of the page. */
export const packageOf = (name) => require(name);
export const packageFile = (path) => join(inspector, 'node_modules', path);

const settings = (build, modules) => ({
  stdin: {contents: modules.map((module) => `export * from './src/${module}';`).join('\n'), resolveDir: inspector},
  bundle: true, logLevel: 'warning', alias: {forewalk: resolve(build, 'wasm/service/wasm/package/index.js')},
});

/** What modules of the page export, with what they need. `build`: the project's build folder. */
export async function source(build, ...modules) {
  const folder = mkdtempSync(join(tmpdir(), 'forewalk-'));
  const file = join(folder, 'bundle.mjs');
  await esbuild.build({
    ...settings(build, modules), outfile: file, format: 'esm', platform: 'node', target: 'node18', external: ['node:*'],
  });
  const exported = await import(pathToFileURL(file));
  rmSync(folder, {recursive: true});
  return exported;
}

/** The same as a script for a page, which has them in the global `name`. */
export async function bundle(build, name, ...modules) {
  const {outputFiles} = await esbuild.build({
    ...settings(build, modules), write: false, format: 'iife', globalName: name,
  });
  return `${outputFiles[0].text};window.${name} = ${name};`;
}

/** The library, as the page has it. */
export const library = async (build) =>
  (await import(pathToFileURL(resolve(build, 'wasm/service/wasm/package/index.js')))).load();

/** A bundled building: its navmesh, start and tour. */
export function building(build, forewalk, id) {
  const scenario = JSON.parse(readFileSync(join(inspector, '../../assets/scenarios', `${id}.json`)));
  return {
    navmesh: forewalk.navmesh(readFileSync(resolve(build, 'inspector/buildings', `${id}.fwmesh`))),
    start: {floor: scenario.start.position, heading: scenario.start.heading_deg * Math.PI / 180},
    tour: scenario.waypoints,
  };
}
export const buildingIds = ['museum', 'office', 'two_storey', 'maze', 'corridor'];
