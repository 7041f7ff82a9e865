// The page without a mouse, and its text in both themes: keyboard.mjs PAGE FOLDER
//
// Every control is reached by Tab, has a name and shows the focus; every key of the help does what it says. Text has a
// contrast of 4.5 to 1 or more, worked out from the styles that the browser uses.
import assert from 'node:assert/strict';
import {openBrowser, openPage, pageFile} from './browser.mjs';

const [pages] = process.argv.slice(2);
const browser = await openBrowser();

const {page, errors} = await openPage(browser, pageFile(pages, '?play=0&scene=office&walker=tour'));
const state = () => page.evaluate(() => ({
  frame: inspector.player.frame, time: inspector.player.time, playing: inspector.player.playing,
  length: inspector.player.source.walk.length, follows: inspector.building.following,
}));
const focusedOn = () => page.evaluate(() => document.activeElement.id || document.activeElement.tagName);

// Around the page by Tab.
const wanted = await page.evaluate(() => [...document.querySelectorAll('button, select, input, [tabindex]')]
  .filter((element) => !element.disabled && element.checkVisibility() && element.type !== 'file')
  .map((element) => element.id));
const reached = new Map();
for (let i = 0; i < wanted.length + 10; ++i) {
  await page.keyboard.press('Tab');
  const seen = await page.evaluate(() => {
    const element = document.activeElement;
    const style = getComputedStyle(element);
    const name = element.ariaLabel || [...element.labels ?? []].map((label) => label.innerText).join(' ') || element.innerText;
    return {id: element.id, name, outline: style.outlineStyle === 'none' ? 0 : Number.parseFloat(style.outlineWidth)};
  });
  if (seen.id) reached.set(seen.id, seen);
}
assert.deepEqual(wanted.filter((id) => !reached.has(id)), [], 'reached by Tab');
for (const {id, name, outline} of reached.values()) {
  assert.ok(name.trim().length > 0, `${id} has a name`);
  assert.ok(outline >= 2, `${id} shows the focus`);
}
console.log(`${reached.size} controls reached by Tab, all with a name and a focus ring`);

// The keys, with the focus nowhere.
await page.evaluate(() => document.activeElement.blur());
await page.keyboard.press('Space');
assert.ok((await state()).playing);
await page.waitForFunction(() => inspector.player.source.walk.duration > 12, null, {timeout: 120_000});
await page.keyboard.press('Space');
assert.ok(!(await state()).playing);
await page.keyboard.press('Home');
assert.equal((await state()).frame, 0);
await page.keyboard.press('ArrowRight');
await page.keyboard.press('ArrowRight');
await page.keyboard.press('ArrowLeft');
assert.equal((await state()).frame, 1);
await page.keyboard.press('Shift+ArrowRight');
assert.ok(Math.abs((await state()).time - 5 - 1 / 90) < 0.02);
await page.keyboard.press('End');
const end = await state();
assert.equal(end.frame, end.length - 1);
await page.keyboard.press('ArrowRight');
assert.equal((await state()).length, end.length + 1, 'a step past the end of a walk in the page makes a frame');
await page.evaluate(() => { inspector.player.source.reach(inspector.player.source.walk.duration + 1); });
await page.keyboard.press('Home');
for (let i = 0; i < 80 && await page.evaluate(() => inspector.player.source.walk.resetFrames.length) === 0; ++i) {
  await page.evaluate(() => { inspector.player.source.reach(inspector.player.source.walk.duration + 1); });
}
await page.keyboard.press(']');
assert.equal((await state()).frame, await page.evaluate(() => inspector.player.source.walk.resetFrames[0]));
await page.keyboard.press('End');
await page.keyboard.press('[');
assert.equal((await state()).frame, await page.evaluate(() => inspector.player.source.walk.resetFrames.at(-1)));
const zoom = () => page.evaluate(() => inspector.building.place([0, 0, 0]).join());
for (const key of ['+', '-']) {
  const before = await zoom();
  await page.keyboard.press(key);
  assert.notEqual(await zoom(), before, `${key} zooms`);
}
await page.keyboard.press('f');
assert.ok(!(await state()).follows);
await page.keyboard.press('f');
assert.ok((await state()).follows);
await page.keyboard.press('?');
assert.ok(await page.isVisible('#help'));
await page.keyboard.press('Escape');
assert.ok(!await page.isVisible('#help'));

// The building's own keys.
await page.focus('#building-canvas');
const frame = (await state()).frame;
for (const key of ['ArrowLeft', 'ArrowUp', 'Shift+ArrowLeft']) {
  const before = await zoom();
  await page.keyboard.press(key);
  assert.notEqual(await zoom(), before, `${key} moves the camera`);
}
assert.equal((await state()).frame, frame, 'and not the time');
assert.ok(!(await state()).follows, 'who looks elsewhere does not follow');
await page.keyboard.press('f');
await page.waitForTimeout(1500);
await page.keyboard.press('Enter');
assert.match(await page.textContent('#picked'), /^Polygon \d+ at/);
assert.equal(await page.getAttribute('#picked', 'aria-live'), 'polite');

// Choosing by the keyboard begins another walk; W walks it.
await page.focus('#walker');
await page.keyboard.press('End');
await page.waitForFunction(() => inspector.player.source.walk.length <= 2);
await page.evaluate(() => document.activeElement.blur());
await page.keyboard.press('Space');
await page.keyboard.down('KeyW');
await page.waitForFunction(() => inspector.player.source.walk.walkedPhysical[inspector.player.source.walk.length - 1] > 0.5, null, {timeout: 30_000});
await page.keyboard.up('KeyW');
await page.keyboard.press('Space');
console.log('every key does what the help says; the focus on the building keeps the arrows there; W walks');

// A button takes its own space.
await page.focus('#zoom-in');
const playing = (await state()).playing;
await page.keyboard.press('Space');
assert.equal((await state()).playing, playing);
assert.deepEqual(errors, []);
await page.close();

/** Contrast of each piece of text that is seen with what is behind it. */
const contrasts = () => {
  const parse = (text) => {
    const [r, g, b, a = 1] = text.match(/[\d.]+%?/g).map((n) => n.endsWith('%') ? Number.parseFloat(n) / 100 : Number(n));
    return [r, g, b, a];
  };
  const over = (top, below) => [0, 1, 2].map((i) => top[i] * top[3] + below[i] * (1 - top[3])).concat(1);
  const luminance = (color) => color.slice(0, 3).map((c) => c / 255)
    .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const behind = (element) => {
    const layers = [];
    for (let at = element; at; at = at.parentElement) layers.push(parse(getComputedStyle(at).backgroundColor));
    return layers.reverse().reduce((below, top) => over(top, below), [255, 255, 255, 1]);
  };
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let text = walker.nextNode(); text; text = walker.nextNode()) {
    const element = text.parentElement;
    if (!text.data.trim() || !element.checkVisibility({visibilityProperty: true}) || element.closest('script')) continue;
    const back = behind(element);
    const [a, b] = [luminance(over(parse(getComputedStyle(element).color), back)), luminance(back)];
    found.push({text: text.data.trim().slice(0, 30), ratio: (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05)});
  }
  return found;
};
for (const colorScheme of ['light', 'dark']) {
  const {page: themed} = await openPage(browser, pageFile(pages, '?play=0'), {colorScheme});
  await themed.evaluate(() => {
    document.getElementById('help').showModal();
    document.getElementById('picked').textContent = 'Polygon';
    document.getElementById('border').classList.add('warned');
    document.getElementById('notice').hidden = false;
    document.querySelector('#notice p').textContent = 'Notice';
  });
  const found = await themed.evaluate(contrasts);
  const worst = found.reduce((a, b) => b.ratio < a.ratio ? b : a);
  console.log(`${colorScheme}: ${found.length} texts, the least contrast ${worst.ratio.toFixed(2)} ("${worst.text}")`);
  assert.ok(found.length > 60);
  assert.ok(worst.ratio >= 4.5, `${worst.text}: ${worst.ratio}`);
  await themed.close();
}
await browser.close();
