// The npm package canopen as the master of a testee (tests/cross/PROTOCOL.md), in the testee's time.
//
// Standard input, JSON:
//   program    the testee's command line
//   node_id    of the device
//   receive, transmit   PDOs of the master: {"385": ["UNSIGNED16"]}, types by CAN-ID (decimal)
//   steps      one list each:
//     ["line", text]                         anything that the testee understands
//     ["upload", index, sub, type]           without a type the octets are given
//     ["upload_in_blocks", index, sub]
//     ["download", index, sub, value, type]  without a type the value is octets
//     ["nmt", method, node-ID]               such as startNode; 0 is everybody
//     ["sync"]
//     ["pdo", CAN-ID, values]
//
// Standard output, JSON: the version, and what came of each step: `value` or `abort` (a code) of SDO, the frames `sent`
// by the package, and what it `heard`, as it understands it. Octets are text in hexadecimal.

"use strict";

const { spawn } = require("node:child_process");
const { readFileSync } = require("node:fs");
const { createInterface } = require("node:readline");

// The only use of this addon, which has to be compiled, is the checksum of block transfers.
require.cache[require.resolve("node-crc")] = { exports: { crc: undefined }, loaded: true };

const { DataType, Device, Eds, NmtState, SdoError } = require("canopen");
const { version } = require("canopen/package.json");

const PATIENCE = 60000; // ms; the package's own time-outs are not those of the testee

const hex = (octets) => Buffer.from(octets).toString("hex").toUpperCase();

/** A running testee. Lines may be asked before earlier ones are answered. */
class Testee {
  constructor([program, ...options], onFrame) {
    this.process = spawn(program, options, { stdio: ["pipe", "pipe", "inherit"] });
    this.ended = new Promise((resolve) => this.process.on("close", resolve));
    this.waiting = [];
    createInterface(this.process.stdout).on("line", (line) => {
      const [word, id, ...octets] = line.split(" ");
      if (word === "TX") onFrame({ id: parseInt(id, 16), data: Buffer.from(octets.join(""), "hex") });
      if (word === "NACK") throw new Error(line);
      if (word === "NEXT") this.waiting.shift()();
    });
  }

  ask(line) {
    this.process.stdin.write(`${line}\n`);
    return new Promise((resolve) => this.waiting.push(resolve));
  }

  /** All that was asked is answered, and what it was answered has led to nothing more. */
  async settle() {
    while (this.waiting.length) await this.ask("T 0");
  }

  close() {
    this.process.stdin.end();
    return this.ended;
  }
}

/** A device of the package, set up to be the master of one node. */
function makeMaster({ node_id, receive, transmit }, own) {
  const eds = new Eds();
  eds.addSdoClientParameter(node_id, 0x600 + node_id, 0x580 + node_id);
  eds.addEmcyConsumer(0x80 + node_id);
  eds.addHeartbeatConsumer(node_id, PATIENCE);
  eds.setSyncCobId(0x80);
  eds.setSyncGenerationEnable(true);
  let index = 0x2000;
  const pdo = ([id, types]) => {
    const dataObjects = types.map((type) => {
      index += 1;
      return eds.addEntry(index, { parameterName: `Value ${index}`, dataType: DataType[type], pdoMapping: true });
    });
    own[id] = dataObjects;
    return { cobId: Number(id), transmissionType: 255, inhibitTime: 0, eventTime: 0, dataObjects };
  };
  Object.entries(receive).forEach((one) => eds.addReceivePdo(pdo(one)));
  Object.entries(transmit).forEach((one) => eds.addTransmitPdo(pdo(one)));
  return new Device({ eds, id: 127 });
}

/** JSON has no integers of 64 bits. */
const plain = (value) => (Buffer.isBuffer(value) ? hex(value) : typeof value === "bigint" ? Number(value) : value);

async function main() {
  const task = JSON.parse(readFileSync(0, "utf8"));
  const own = {};
  let sent = [];
  let heard = [];
  const master = makeMaster(task, own);
  const testee = new Testee([...task.program, "--node-id", String(task.node_id)], (frame) => master.receive(frame));

  master.on("message", ({ id, data }) => {
    const octets = hex(data).replace(/../g, " $&");
    sent.push(id.toString(16).toUpperCase().padStart(3, "0") + octets);
    testee.ask(`RX ${sent.at(-1)}`);
  });
  master.nmt.on("heartbeat", ({ deviceId, state }) => heard.push(["state", deviceId, state]));
  master.emcy.on("emergency", ({ cobId, em }) =>
    heard.push(["emergency", cobId, em.code, em.register, hex(em.info), em.toString()]));
  master.pdo.on("pdo", ({ cobId, dataObjects }) =>
    heard.push(["pdo", cobId, dataObjects.map(({ value }) => plain(value))]));

  const deviceId = task.node_id;
  const timeout = PATIENCE;
  const actions = {
    line: (text) => testee.ask(text),
    upload: (index, subIndex, type) =>
      master.sdo.upload({ deviceId, timeout, index, subIndex, dataType: type && DataType[type] }),
    upload_in_blocks: (index, subIndex) =>
      master.sdo.upload({ deviceId, timeout, index, subIndex, blockTransfer: true }),
    download: (index, subIndex, value, type) =>
      master.sdo.download(
        type
          ? { deviceId, timeout, index, subIndex, data: value, dataType: DataType[type] }
          : { deviceId, timeout, index, subIndex, data: Buffer.from(value, "hex") }
      ),
    nmt: (method, nodeId) => master.nmt[method](nodeId),
    sync: () => master.sync.write(),
    pdo: (id, values) => {
      values.forEach((value, place) => (own[id][place].value = value));
      master.pdo.write(id);
    },
  };

  master.start();
  master.nmt.setState(NmtState.OPERATIONAL);
  const answers = [];
  for (const [action, ...values] of task.steps) {
    const answer = {};
    try {
      const value = await actions[action](...values);
      if (action.startsWith("upload")) answer.value = plain(value);
    } catch (error) {
      if (!(error instanceof SdoError)) throw error;
      answer.abort = error.code;
    }
    await testee.settle();
    answers.push({ ...answer, sent, heard });
    sent = [];
    heard = [];
  }
  master.stop();
  const status = await testee.close();
  process.stdout.write(JSON.stringify({ version, status, answers }), () => process.exit());
}

main();
