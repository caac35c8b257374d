// A line between a page and its server that can be cut: everything that goes through it breaks, and nothing new gets
// through, until it is mended.
import { createServer, connect } from 'node:net';
import { once } from 'node:events';

export class Line {
  static async to(url) {
    const line = new Line();
    const { hostname, port } = new URL(url);
    line.sockets = new Set();
    line.isCut = false;
    line.server = createServer((near) => line.join(near, connect(Number(port), hostname)));
    line.server.listen(0, '127.0.0.1');
    await once(line.server, 'listening');
    line.url = `http://127.0.0.1:${line.server.address().port}`;
    return line;
  }

  cut() {
    this.isCut = true;
    for (const socket of this.sockets) socket.destroy();
  }

  mend() {
    this.isCut = false;
  }

  close() {
    this.cut();
    this.server.close();
  }

  join(near, far) {
    if (this.isCut) {
      near.destroy();
      far.destroy();
      return;
    }
    for (const [socket, other] of [
      [near, far],
      [far, near],
    ]) {
      this.sockets.add(socket);
      socket.on('error', () => other.destroy());
      socket.on('close', () => {
        this.sockets.delete(socket);
        other.destroy();
      });
      socket.pipe(other);
    }
  }
}
