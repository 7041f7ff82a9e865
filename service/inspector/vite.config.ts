// One index.html with everything inside, so that it also opens from disk, without a server.
//
// FOREWALK_BUILD names the project's build folder, where the WebAssembly package and the bundled buildings'
// navmeshes are made before (./forewalk.sh inspector).
import {readFileSync, readdirSync} from 'node:fs';
import {fileURLToPath} from 'node:url';
import {resolve} from 'node:path';
import {defineConfig, type Plugin} from 'vite';
import {viteSingleFile} from 'vite-plugin-singlefile';
import {roomFromCapture} from './src/vr/scan';

const here = fileURLToPath(new URL('.', import.meta.url));
const build = resolve(process.env.FOREWALK_BUILD ?? resolve(here, '../../build'));

// `import bytes from 'x.fwmesh?bytes'`: the file as base64, which works where fetch does not (file://).
const bytes: Plugin = {
  name: 'bytes',
  load(id) {
    if (!id.endsWith('?bytes')) return null;
    return `export default "${readFileSync(id.slice(0, -'?bytes'.length)).toString('base64')}";`;
  },
};

// `import rooms from 'virtual:scanned-rooms'`: the captures of @iwer/sem as corners, to the millimetre.
const scannedRooms: Plugin = {
  name: 'scanned-rooms',
  resolveId: (id) => id === 'virtual:scanned-rooms' ? `\0${id}` : null,
  load(id) {
    if (id !== '\0virtual:scanned-rooms') return null;
    const captures = resolve(here, 'node_modules/@iwer/sem/captures');
    const rooms = readdirSync(captures).sort().map((file) =>
      roomFromCapture(file.replace('.json', '').replace('_', ' '), JSON.parse(readFileSync(resolve(captures, file), 'utf8'))));
    return `export default ${JSON.stringify(rooms, (_, value) =>
      typeof value === 'number' ? Math.round(1000 * value) / 1000 : value)};`;
  },
};

export default defineConfig({
  root: here,
  base: './',
  plugins: [bytes, scannedRooms, viteSingleFile()],
  resolve: {
    alias: {
      forewalk: resolve(build, 'wasm/service/wasm/package/index.js'),
      '@buildings': resolve(build, 'inspector/buildings'),
      '@assets': resolve(here, '../../assets'),
    },
  },
  build: {
    outDir: resolve(build, 'inspector/page'),
    emptyOutDir: true,
    target: 'es2022',
    chunkSizeWarningLimit: 8192,
  },
});
