// The library in the page against the native one: agreement.mjs PAGE NATIVE_WALK FOLDER
//
// The walks that C, C# and OpenXR are tested with (tests/service/wasm/native_walk.cpp), walked once more by the page in
// the browser. Prints the farthest that any virtual pose lies off, and fails beyond 1e-4.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync, readdirSync} from 'node:fs';
import {join} from 'node:path';
import {emptyFolder, jsonLines, openBrowser, openPage, pageFile} from './browser.mjs';

const [pages, native, folder] = process.argv.slice(2);
emptyFolder(folder);
process.stdout.write(execFileSync(native, [folder]));
const browser = await openBrowser();
const {page, errors} = await openPage(browser, pageFile(pages, '?play=0'));
const walks = readdirSync(folder).filter((name) => name.endsWith('.jsonl'));
assert.ok(walks.length >= 3);
for (const file of walks) {
  const name = file.replace('.jsonl', '');
  const [settings, ...frames] = jsonLines(join(folder, file));
  const result = await page.evaluate(([fwmesh, head, lines]) => {
    const navmesh = forewalk.navmesh(Uint8Array.from(atob(fwmesh), (letter) => letter.charCodeAt(0)));
    const session = navmesh.session(head);
    let position = 0, orientation = 0, resets = 0, differ = 0;
    for (const line of lines) {
      const frame = session.frame(line.slice(1, 4), line.slice(4, 8), line[0]);
      for (let i = 0; i < 3; ++i) position = Math.max(position, Math.abs(frame.position[i] - line[8 + i]));
      for (let i = 0; i < 4; ++i) orientation = Math.max(orientation, Math.abs(frame.orientation[i] - line[11 + i]));
      if (frame.flags !== line[15] || frame.resetCount !== line[16] || frame.graphNodes !== line[17]) ++differ;
      resets = frame.resetCount;
    }
    session.release();
    navmesh.release();
    return {position, orientation, resets, differ};
  }, [readFileSync(join(folder, `${name}.fwmesh`)).toString('base64'), settings, frames]);
  console.log(`${name}: ${frames.length} frames in the browser, at most ${result.position.toExponential(1)} m and ` +
    `${result.orientation.toExponential(1)} off, ${result.differ} with other flags, resets or nodes`);
  assert.ok(frames.length > 1000 && result.resets > 0);
  assert.ok(result.position <= 1e-4 && result.orientation <= 1e-4, `${name}: not within 1e-4`);
}
assert.deepEqual(errors, []);
await browser.close();
