import assert from "node:assert/strict";
import test from "node:test";
import {
  formatArea,
  formatDms,
  formatEstimate,
  formatLatLon,
  formatLength,
  formatMap,
  formatVolume,
  niceScale,
  shortVertical,
} from "../../../src/geo/format.js";

test("lengths, areas, volumes", () => {
  assert.equal(formatLength(12.344), "12.34 m");
  assert.equal(formatLength(0.1234), "0.123 m");
  assert.equal(formatLength(-0.0001), "0.000 m");
  assert.equal(formatLength(-3), "-3.00 m");
  assert.equal(formatLength(999.999), "1000.0 m");
  assert.equal(formatLength(12345.6), "12.346 km");
  assert.equal(formatLength(9999.96), "10.000 km");
  assert.equal(formatArea(12.34), "12.3 m²");
  assert.equal(formatArea(123456), "12.35 ha");
  assert.equal(formatArea(2.5e7), "25.00 km²");
  assert.equal(formatVolume(1234.5), "1235 m³");
  assert.equal(formatVolume(0.126), "0.13 m³");
  assert.equal(formatLength(Number.NaN), "–");
  assert.equal(formatVolume(Number.POSITIVE_INFINITY), "–");
});

test("estimates have the digits that their sigma allows", () => {
  const estimate = (value: number, sigma: number | null) => formatEstimate({ value, sigma }, "length");
  assert.equal(estimate(12.3412, 0.0512), "12.34 m ± 0.05 m");
  assert.equal(estimate(12.3412, 0.0123), "12.341 m ± 0.012 m");
  assert.equal(estimate(12.3412, 0.0996), "12.34 m ± 0.10 m");
  assert.equal(estimate(12.3412, 0.97), "12.3 m ± 1.0 m");
  assert.equal(estimate(12.3412, 3.2), "12 m ± 3 m");
  assert.equal(estimate(1234.9, 250), "1235 m ± 250 m");
  assert.equal(estimate(12.3412, 0.00001), "12.341 m ± <0.001 m");
  assert.equal(estimate(12.3412, 0), "12.341 m ± <0.001 m");
  assert.equal(estimate(12.3412, null), "12.34 m");
  assert.equal(estimate(12.3412, Number.NaN), "12.34 m");
  assert.equal(estimate(Number.NaN, 1), "–");
  assert.equal(estimate(-0.0004, 0.02), "0.00 m ± 0.02 m");
  assert.equal(estimate(15000, 2), "15.000 km ± 0.002 km");
  assert.equal(formatEstimate({ value: 123456, sigma: 789 }, "area"), "12.35 ha ± 0.08 ha");
  assert.equal(formatEstimate({ value: 80.26, sigma: 2.4 }, "volume"), "80 m³ ± 2 m³");
});

test("coordinates", () => {
  assert.equal(formatLatLon(47.3769, 8.5417), "47.3769000° N, 8.5417000° E");
  assert.equal(formatLatLon(-33.8568, -70.5), "33.8568000° S, 70.5000000° W");
  assert.equal(formatDms(47.3769, 8.5417), "47°22′36.84″ N, 8°32′30.12″ E");
  assert.equal(formatDms(-0.9999999999, 179.9999999999), "1°00′00.00″ S, 180°00′00.00″ E");
  assert.equal(formatMap([465403.284466, 5247150.839425]), "465403.28 E, 5247150.84 N");
  assert.equal(formatMap([Number.NaN, 0, 1]), "–");
  assert.equal(formatLatLon(Number.NaN, 0), "–");
});

test("scale bars: the longest 1, 2 or 5 that fits", () => {
  const cases: readonly (readonly [number, number, string])[] = [
    [0.0034, 0.002, "2 mm"],
    [0.07, 0.05, "5 cm"],
    [0.999, 0.5, "50 cm"],
    [1, 1, "1 m"],
    [4.99, 2, "2 m"],
    [5, 5, "5 m"],
    [1000, 1000, "1 km"],
    [999.9, 500, "500 m"],
    [73000, 50000, "50 km"],
    [0.0005, 0.0005, "0.5 mm"],
  ];
  for (const [max, lengthM, text] of cases) {
    const bar = niceScale(max);
    assert.ok(bar !== null && Math.abs(bar.lengthM - lengthM) < 1e-12 * lengthM, `${max}: ${bar?.lengthM}`);
    assert.equal(bar.text, text);
  }
  for (let exponent = -3; exponent < 6; exponent += 1) assert.equal(niceScale(10 ** exponent)?.lengthM, 10 ** exponent);
  for (const max of [0, -1, Number.NaN, Number.POSITIVE_INFINITY]) assert.equal(niceScale(max), null);
});

test("the datum in short", () => {
  assert.equal(shortVertical("heights above the WGS84 ellipsoid"), "WGS84 ellipsoid");
  assert.equal(shortVertical("local metres"), "local metres");
});
