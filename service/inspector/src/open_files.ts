// Recordings and navmeshes from disk, by the file picker or dropped on the page; and walks to disk.
import {get} from './dom';
import {notice, showProgress} from './notices';
import {readRecording, RecordingError, recordingText} from './recording';
import type {Walk} from './walk';

export interface FileUses {
  /** A navmesh's bytes. */
  navmesh(name: string, bytes: Uint8Array): void;
  recording(name: string, walk: Walk): void;
}

let reading: AbortController | null = null;

/** Opens files: navmeshes first, since a recording may walk in them. */
export async function openFiles(files: readonly File[], uses: FileUses): Promise<void> {
  const navmeshes = files.filter((file) => file.name.endsWith('.fwmesh'));
  for (const file of navmeshes) uses.navmesh(file.name, new Uint8Array(await file.arrayBuffer()));
  const recordings = files.filter((file) => !navmeshes.includes(file));
  if (recordings.length > 1) notice(`${recordings.length} recordings at once: the first, ${recordings[0].name}, is opened.`);
  if (recordings.length > 0) await openRecording(recordings[0], uses);
}

async function openRecording(file: File, uses: FileUses): Promise<void> {
  reading?.abort();
  const own = new AbortController();
  reading = own;
  const progress = showProgress(file.name, () => own.abort());
  try {
    const walk = await readRecording(file, progress.move, own.signal);
    progress.end();
    uses.recording(file.name, walk);
  } catch (fault) {
    if (reading === own) progress.end();
    if (own.signal.aborted) return;
    notice(fault instanceof RecordingError ? fault.message
      : `${file.name} could not be read: ${(fault as Error).message}`);
  } finally {
    if (reading === own) reading = null;
  }
}

/** Listens to the picker, and to files that are dragged over the page. */
export function listenToFiles(uses: FileUses): void {
  const picker = get<HTMLInputElement>('file');
  get('open').addEventListener('click', () => picker.click());
  picker.addEventListener('change', () => {
    void openFiles([...picker.files ?? []], uses);
    picker.value = '';  // so that the same file can be opened again
  });
  const over = get('drop');
  const carriesFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;
  addEventListener('dragover', (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    over.hidden = false;
  });
  addEventListener('dragleave', (event) => { if (!event.relatedTarget) over.hidden = true; });
  addEventListener('drop', (event) => {
    over.hidden = true;
    if (!carriesFiles(event)) return;
    event.preventDefault();
    void openFiles([...event.dataTransfer!.files], uses);
  });
}

/** Hands a walk to the browser's downloads. */
export function saveRecording(walk: Walk): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob(recordingText(walk), {type: 'application/jsonl'}));
  link.download = `${walk.head.session || 'walk'}.jsonl`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
