// What the headset shows, as pictures: node vr_pictures.mjs BUILD FOLDER [SIDE]
import {mkdirSync} from 'node:fs';
import {join} from 'node:path';
import {openBrowser} from './browser.mjs';
import {enter, openPage, picture, walk} from './vr_page.mjs';

const [build, folder, side = 800] = process.argv.slice(2);
mkdirSync(folder, {recursive: true});
const browser = await openBrowser();
const page = await openPage(browser, build, {side: Number(side)});
const shoot = async (name, settings) => {
  await walk(page, {drawn: 1000, ...settings});
  await picture(page, join(folder, `vr_${name}.png`));
  console.log(join(folder, `vr_${name}.png`));
};
await page.setViewportSize({width: 1280, height: 800});
await page.click('#enter-vr:enabled');
await page.check('input[value="scanned"]');
await page.screenshot({path: join(folder, 'vr_dialog.png')});
await page.click('#vr-cancel');
await page.setViewportSize({width: Number(side), height: Number(side)});
await enter(page, {building: 'museum', room: 'drawn', sides: [5, 5]});
await shoot('building', {seconds: 2});
await shoot('prompt', {seconds: 30, until: 'prompt'});
await shoot('marker', {seconds: 10, until: 'marker'});
await shoot('doorway', {metres: 40});
await browser.close();
