// One index.html with everything inside, so that it also opens from disk, without a server.
//
// FOREWALK_BUILD names the project's build folder, where the WebAssembly package and the bundled buildings'
// navmeshes are made before (./forewalk.sh inspector).
import {readFileSync} from 'node:fs';
import {fileURLToPath} from 'node:url';
import {resolve} from 'node:path';
import {defineConfig, type Plugin} from 'vite';
import {viteSingleFile} from 'vite-plugin-singlefile';

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

export default defineConfig({
  root: here,
  base: './',
  plugins: [bytes, viteSingleFile()],
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
