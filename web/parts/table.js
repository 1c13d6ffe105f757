// A table that renders only the rows in sight; rows may arrive late.
import { useEffect, useRef, useState } from "preact/hooks";
import { cx, html } from "../html.js";

/**
 * @template T
 * @typedef {object} TableColumn
 * @property {string} key
 * @property {string} label
 * @property {string} width a track of a CSS grid
 * @property {boolean} [sortable]
 * @property {boolean} [number] right-aligned
 * @property {string} [hint]
 * @property {(row: T) => import("../html.js").Children} cell
 */

/**
 * @template T
 * @typedef {object} TableProps
 * @property {string} label what the table lists, for screen readers
 * @property {TableColumn<T>[]} columns
 * @property {number} total
 * @property {(index: number) => T | undefined} rowAt undefined while the row is on its way
 * @property {(first: number, last: number) => void} [onRange] rows in sight
 * @property {number} selected index, -1 for none
 * @property {(index: number, event?: MouseEvent) => void} onSelect
 * @property {(index: number) => boolean} [chosen] whether a row is one of several that are chosen together
 * @property {string} order a column's key, with a minus in front for descending
 * @property {(order: string) => void} onOrder
 */

const ROW_PX = 28;
const SPARE_ROWS = 6;

/**
 * @template T
 * @param {TableProps<T>} props
 */
export function Table(props) {
  const { columns, total, selected } = props;
  const body = useRef(/** @type {HTMLDivElement | null} */ (null));
  const [view, setView] = useState({ top: 0, height: 400 });
  const first = Math.max(0, Math.floor(view.top / ROW_PX) - SPARE_ROWS);
  const last = Math.min(total, Math.ceil((view.top + view.height) / ROW_PX) + SPARE_ROWS);

  useEffect(() => props.onRange?.(first, last), [first, last, total]);
  useEffect(() => watchSize(body.current, setView), []);
  useEffect(() => keepInSight(body.current, selected), [selected, view.height]);

  const tracks = columns.map((column) => column.width).join(" ");
  const indices = Array.from({ length: Math.max(0, last - first) }, (_, i) => first + i);
  return html`<div
    class="table"
    role="table"
    aria-label=${props.label}
    aria-rowcount=${total + 1}
    aria-multiselectable=${props.chosen ? "true" : undefined}
  >
    <div class="table-head" role="row" aria-rowindex="1" style=${{ gridTemplateColumns: tracks }}>
      ${columns.map((column) => header(column, props))}
    </div>
    <div
      class="table-body"
      role="rowgroup"
      tabindex="0"
      aria-label=${`${props.label}, rows`}
      ref=${body}
      onKeyDown=${(/** @type {KeyboardEvent} */ event) => move(event, props)}
      onScroll=${(/** @type {{currentTarget: HTMLDivElement}} */ { currentTarget: at }) =>
        setView({ top: at.scrollTop, height: at.clientHeight })}
    >
      <div class="table-space" role="presentation" style=${{ height: `${total * ROW_PX}px` }}>
        ${indices.map((index) => tableRow(index, tracks, props))}
      </div>
    </div>
  </div>`;
}

/**
 * @template T
 * @param {TableColumn<T>} column
 * @param {TableProps<T>} props
 */
function header({ key, label, number, sortable, hint }, { order, onOrder }) {
  const down = order === `-${key}`;
  const sort = order === key ? "ascending" : down ? "descending" : undefined;
  const mark = sort ? html`<span class="sort-mark" aria-hidden="true">${down ? "▾" : "▴"}</span>` : null;
  const text = sortable
    ? html`<button type="button" onClick=${() => onOrder(down ? key : `-${key}`)}>${label}${mark}</button>`
    : label;
  return html`<div role="columnheader" aria-sort=${sort} title=${hint} class=${cx("cell", number && "right")}>${text}</div>`;
}

/**
 * @template T
 * @param {number} index
 * @param {string} tracks
 * @param {TableProps<T>} props
 */
function tableRow(index, tracks, { columns, rowAt, selected, chosen, onSelect }) {
  const row = rowAt(index);
  const cells = columns.map(
    ({ key, number, cell }) =>
      html`<div key=${key} role="cell" class=${cx("cell", number && "right")}>${row === undefined ? "" : cell(row)}</div>`,
  );
  return html`<div
    key=${index}
    role="row"
    aria-rowindex=${index + 2}
    aria-selected=${index === selected || Boolean(chosen?.(index))}
    class=${cx("table-row", chosen?.(index) && "chosen")}
    style=${{ gridTemplateColumns: tracks, transform: `translateY(${index * ROW_PX}px)` }}
    onMouseDown=${(/** @type {MouseEvent} */ event) => chosen && event.shiftKey && event.preventDefault()}
    onClick=${(/** @type {MouseEvent} */ event) => onSelect(index, event)}
  >
    ${cells}
  </div>`;
}

/**
 * @param {HTMLDivElement | null} body
 * @param {(view: {top: number, height: number}) => void} setView
 */
function watchSize(body, setView) {
  if (!body) return undefined;
  const observer = new ResizeObserver(() => setView({ top: body.scrollTop, height: body.clientHeight }));
  observer.observe(body);
  return () => observer.disconnect();
}

/** @param {HTMLDivElement | null} body @param {number} index */
function keepInSight(body, index) {
  if (!body || index < 0) return;
  const top = index * ROW_PX;
  if (top < body.scrollTop) body.scrollTop = top;
  else if (top + ROW_PX > body.scrollTop + body.clientHeight) body.scrollTop = top + ROW_PX - body.clientHeight;
}

/**
 * @template T
 * @param {KeyboardEvent} event
 * @param {TableProps<T>} props
 */
function move(event, { total, selected, onSelect }) {
  /** @type {Record<string, number>} */
  const target = {
    ArrowDown: selected + 1,
    ArrowUp: selected - 1,
    PageDown: selected + 12,
    PageUp: selected - 12,
    Home: 0,
    End: total - 1,
  };
  if (!(event.key in target) || !total) return;
  event.preventDefault();
  onSelect(Math.max(0, Math.min(total - 1, target[event.key])));
}
