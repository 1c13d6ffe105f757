// The queue's filter as part of its address, so that a link shows what its sender saw.
import { NO_FILTER, RANGES } from "./loop_list.js";

/** @typedef {import("./loop_list.js").LoopFilterState} LoopFilterState */

/** @param {LoopFilterState} filter @returns {Record<string, string>} what differs from no filter */
export function queryOf({ states, suspect, type, minInliers, session, ranges }) {
  return {
    ...(states.length && { state: states.join(",") }),
    ...(suspect && { suspect: "1" }),
    ...(type && { type }),
    ...(minInliers && { inliers: String(minInliers) }),
    ...(session !== null && { session: String(session) }),
    ...Object.fromEntries(Object.entries(ranges).map(([key, [least, most]]) => [`in-${key}`, `${least ?? ""}..${most ?? ""}`])),
  };
}

/** @param {URLSearchParams} query @returns {LoopFilterState | null} null where it names none */
export function filterOf(query) {
  const inliers = number(query.get("inliers"));
  /** @type {LoopFilterState} */
  const filter = {
    states: (query.get("state") ?? "").split(",").filter(Boolean),
    suspect: query.get("suspect") === "1",
    type: query.get("type") ?? "",
    minInliers: inliers ?? NO_FILTER.minInliers,
    session: number(query.get("session")),
    ranges: {},
  };
  for (const { key } of RANGES) {
    const [least, most] = (query.get(`in-${key}`) ?? "").split("..").map(number);
    if (least != null || most != null) filter.ranges[key] = [least ?? null, most ?? null];
  }
  return Object.keys(queryOf(filter)).length ? filter : null;
}

/** @param {string | null} text @returns {number | null} */
function number(text) {
  return text === null || text.trim() === "" || !Number.isFinite(Number(text)) ? null : Number(text);
}
