// A browser with the inspector in it, for tests and pictures.
import {createRequire} from 'node:module';
import {mkdirSync, readFileSync, rmSync} from 'node:fs';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';

const require = createRequire(new URL('../../../service/inspector/package.json', import.meta.url));
const {chromium} = require('playwright-core');

/** Chromium without a graphics card: what is drawn, WebGL included, is drawn by the processor. */
export const openBrowser = () => chromium.launch({
  executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--enable-unsafe-swiftshader'],
});

/** The page from disk, as somebody opens it who has no server. */
export const pageFile = (folder, query = '') => pathToFileURL(join(folder, 'index.html')).href + query;

/**
 * A page that is ready, with `errors` for whatever it reports to the console and `requests` for all it asks for.
 */
export async function openPage(browser, url, options = {}) {
  const page = await browser.newPage({viewport: {width: 1280, height: 800}, ...options});
  const errors = [];
  const requests = [];
  page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', (error) => errors.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(url);
  await page.waitForSelector('html[data-ready]', {timeout: 60_000, state: 'attached'});
  return {page, errors, requests};
}

/** Opens a recording by the file picker and waits until it is shown. */
export async function openRecording(page, file) {
  const name = file.replace(/^.*\//, '');
  await page.setInputFiles('#file', file);
  await page.waitForFunction((title) => inspector.player.source?.title.startsWith(title), name, {timeout: 120_000});
}

export function emptyFolder(folder) {
  rmSync(folder, {recursive: true, force: true});
  mkdirSync(folder, {recursive: true});
}

export const jsonLines = (file) => readFileSync(file, 'utf8').trim().split('\n').map((line) => JSON.parse(line));

/** The value below which `share` of the numbers lie. */
export const quantile = (numbers, share) => [...numbers].sort((a, b) => a - b)[Math.min(numbers.length - 1, Math.floor(share * numbers.length))];
