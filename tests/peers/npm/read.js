// The npm package canopen: what its class for EDS files holds. Arguments and output are those of ../readers/program.py.
// Only the module that reads EDS files is loaded: the package as a whole wants a checksum compiled from C.

"use strict";

const { Eds } = require("canopen/source/eds");
const { version } = require("canopen/package.json");

/** JSON has neither `undefined` nor integers of 64 bits: null, and text. */
function plain(value) {
  if (value === undefined) return null;
  if (Buffer.isBuffer(value)) return value.toString();
  return typeof value === "bigint" ? value.toString() : value;
}

function device(eds) {
  const { CreationDate, ModificationDate } = eds.fileInfo;
  return {
    file_name: eds.fileName,
    file_version: eds.fileVersion,
    file_revision: eds.fileRevision,
    eds_version: eds.fileInfo.EDSVersion,
    description: eds.description,
    created: CreationDate && local(eds.creationDate),
    created_by: eds.createdBy,
    modified: ModificationDate && local(eds.modificationDate),
    modified_by: eds.modifiedBy,
    vendor_name: eds.vendorName,
    vendor_number: eds.vendorNumber,
    product_name: eds.productName,
    product_number: eds.productNumber,
    revision_number: eds.revisionNumber,
    order_code: eds.orderCode,
    bit_rates: eds.baudRates.map((rate) => rate / 1000),
    boot_up_master: eds.simpleBootUpMaster,
    boot_up_slave: eds.simpleBootUpSlave,
    granularity: eds.granularity,
    dynamic_channels: eds.dynamicChannelsSupported,
    group_messaging: eds.groupMessaging,
    rpdos: eds.nrOfRXPDO,
    tpdos: eds.nrOfTXPDO,
    lss: eds.lssSupported,
  };
}

/** The package makes dates of the host's time zone; undone here. */
function local(date) {
  const two = (number) => String(number).padStart(2, "0");
  const day = [date.getFullYear(), two(date.getMonth() + 1), two(date.getDate())].join("-");
  return `${day}T${two(date.getHours())}:${two(date.getMinutes())}:00`;
}

function entry(object) {
  return {
    name: object.parameterName,
    sub: object.subIndex || 0,
    type: object.dataType,
    access: object.accessType,
    default: plain(object.defaultValue),
    value: plain(object.value),
    low: plain(object.lowLimit),
    high: plain(object.highLimit),
    mappable: Boolean(object.pdoMapping),
    refuse_write_on_scan: object.objFlags === 1,
  };
}

/** The sub-indices of an object, each with its number; of one that is a variable, itself. */
function subs(object) {
  if (object.subNumber === undefined) return [[0, object]];
  return Array.from({ length: 255 }, (_, sub) => [sub, object.at(sub)]).filter(([, item]) => item);
}

function read(path) {
  const eds = Eds.fromFile(path);
  const tables = { device: { "": device(eds) }, objects: {}, entries: {} };
  for (const [key, object] of eds.entries()) {
    const index = key.toUpperCase();
    const found = subs(object);
    tables.objects[index] = { name: object.parameterName, kind: object.objectType, subs: found.length };
    for (const [sub, item] of found) tables.entries[`${index}:${sub.toString(16).toUpperCase()}`] = entry(item);
  }
  return tables;
}

function reading(file, node_id) {
  const messages = [];
  for (const level of ["log", "info", "warn", "error"]) {
    console[level] = (...words) => messages.push(`${level}: ${words.join(" ")}`);
  }
  try {
    return { file, node_id, messages, tables: read(file) };
  } catch (error) {
    messages.push(`${error.name}: ${error.message}`);
    return { file, node_id, messages, tables: {} };
  }
}

const [nodeIds, ...files] = process.argv.slice(2);
const readings = files.flatMap((file) => nodeIds.split(",").map((id) => reading(file, Number(id))));
process.stdout.write(JSON.stringify({ version, readings }));
