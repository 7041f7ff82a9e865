declare module '*?bytes' {
  const base64: string;
  export default base64;
}

declare module 'virtual:scanned-rooms' {
  const rooms: import('./vr/room').TrackedRoom[];
  export default rooms;
}
