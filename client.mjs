import WebSocket from 'ws';

const socket = new WebSocket('ws://127.0.0.1:7990/v1/session');
const body = {x: 0, z: 0, heading: 0};
let sent = 0, last;

const send = () => {
  const {x, z, heading} = body;
  socket.send(JSON.stringify({
    sequence: sent, seconds: sent / 90, position: [x, 1.7, z],
    orientation: [0, Math.sin(heading / 2), 0, Math.cos(heading / 2)],
  }));
  ++sent;
};

socket.on('open', () => socket.send(JSON.stringify({
  format: 'forewalk.hello/1',
  session: {
    controller: 'foresight', space: {rectangle: [5, 5]},
    start: {position: [21.5, 0, 34], heading_deg: 0},
  },
})));
socket.on('message', (text) => {
  const message = JSON.parse(text);
  if (message.format === 'forewalk.error/1') throw new Error(message.message);
  if (message.format === 'forewalk.welcome/1') return send();
  last = message;  // draw from message.position, message.orientation; keep message.token
  if (message.reset.turning) {
    body.heading += (message.reset.instruction === 'turn_right' ? -1.5 : 1.5) / 90;
  } else {
    body.x -= 1.1 / 90 * Math.sin(body.heading);
    body.z -= 1.1 / 90 * Math.cos(body.heading);
  }
  if (sent < 15 * 90) return setTimeout(send, 5);  // a daemon takes 250 messages a second from each
  const [x, , z] = last.position;
  console.log(`${sent} frames, ${last.reset.count} resets, at (${x.toFixed(1)}, ${z.toFixed(1)})`);
  socket.close();
});
