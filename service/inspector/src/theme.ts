// The page's colours for what is drawn: the light and the dark theme, chosen as the system is. What CSS draws has the
// same values as custom properties in style.css.
import type {BuildingTheme} from './building_model';

export interface Theme extends BuildingTheme {
  name: 'light' | 'dark';
  background: string;
  /** Text, and text that stands back. */
  ink: string;
  quiet: string;
  /** Grid lines and hairlines. */
  rule: string;
  /** The user, the trail, and series of the charts. */
  user: string;
  body: string;
  /** Ways, and the nodes of the prediction graph by their kind. */
  way: string;
  branch: string;
  terminal: string;
  deadEnd: string;
  join: string;
  /** Resets, and a border that is near. */
  reset: string;
  series: [string, string, string, string];
}

export const light: Theme = {
  name: 'light',
  background: '#f4f2ed', ink: '#22252b', quiet: '#5c616b', rule: '#dcd8cf',
  floor: '#e8e4da', wall: '#d8d2c5', furniture: '#cfc7b6', cut: '#4a4d55',
  walkable: '#7fa6c9', walkableOpacity: 0.16, portal: '#8fa3b8', border: '#5f7690',
  sky: '#ffffff', ground: '#b9b2a4',
  user: '#1f5fbf', body: '#1f5fbf', way: '#39618f', branch: '#c8322b', terminal: '#1f8a4c', deadEnd: '#7a7f88',
  join: '#7b4fb3', reset: '#b3540f',
  series: ['#1f5fbf', '#a8500e', '#1f7a48', '#8a3fa0'],
};

export const dark: Theme = {
  name: 'dark',
  background: '#15171b', ink: '#e8e9ec', quiet: '#a0a6b1', rule: '#2c3038',
  floor: '#23262d', wall: '#3b4049', furniture: '#343841', cut: '#99a1ae',
  walkable: '#6f9bc7', walkableOpacity: 0.14, portal: '#4d6178', border: '#7f9bbb',
  sky: '#dfe6f2', ground: '#3c4048',
  user: '#6fb0ff', body: '#6fb0ff', way: '#93b8e0', branch: '#ff6259', terminal: '#4fd186', deadEnd: '#8b919c',
  join: '#b48cf0', reset: '#f2a154',
  series: ['#6fb0ff', '#f2a154', '#5fd394', '#d08be6'],
};

const preference = matchMedia('(prefers-color-scheme: dark)');

export const currentTheme = (): Theme => preference.matches ? dark : light;

/** Calls `changed` whenever the system goes from light to dark or back. */
export function onTheme(changed: (theme: Theme) => void): void {
  preference.addEventListener('change', () => changed(currentTheme()));
}
