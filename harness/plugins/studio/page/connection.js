// The WebSocket to the studio: requests with replies, messages by type, and coming back after a break.

const listeners = {};
const waiting = new Map();
let socket = null, number = 0, isOver = false;

// A page keeps its name over reloads, so that it comes back as the one that controls.
export const page = sessionStorage.page ??= crypto.randomUUID();

export function on(type, listener) { (listeners[type] ??= []).push(listener); }

function emit(type, message) { for (const listener of listeners[type] ?? []) listener(message); }

export function request(name, keys = {}) {
  return new Promise((resolve) => {
    if (socket?.readyState !== WebSocket.OPEN) return resolve({ error: "not connected" });
    const own = ++number;
    waiting.set(own, resolve);
    socket.send(JSON.stringify({ do: name, number: own, ...keys }));
  });
}

/** The other side ends: no attempt to come back. */
export function stop() { isOver = true; }

export function connect() {
  socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/studio/ws`);
  socket.onopen = () => { socket.send(JSON.stringify({ page })); emit("connected", {}); };
  socket.onmessage = (event) => {
    const message = JSON.parse(event.data);
    if (message.type === "reply") { waiting.get(message.number)?.(message); waiting.delete(message.number); }
    else emit(message.type, message);
  };
  socket.onclose = () => {
    for (const resolve of waiting.values()) resolve({ error: "the connection was lost" });
    waiting.clear();
    if (isOver) return;
    emit("lost", {});
    setTimeout(connect, 1000);
  };
}
