// What an API path gives and takes, read off the generated types.
import type { components, paths } from "./api";

export type Schemas = components["schemas"];

type Operation<P extends keyof paths, M extends string> = paths[P] extends Record<M, infer O> ? O : never;

export type Method = "get" | "post" | "patch";

/** Paths that answer a method. */
export type PathOf<M extends Method> = {
  [P in keyof paths]: Operation<P, M> extends { responses: unknown } ? P : never;
}[keyof paths];

export type Ok<P extends keyof paths, M extends Method> =
  Operation<P, M> extends { responses: { 200: { content: { "application/json": infer T } } } } ? T : unknown;

export type Body<P extends keyof paths, M extends Method> =
  Operation<P, M> extends { requestBody: { content: { "application/json": infer T } } } ? T : undefined;

type PathParams<P extends keyof paths, M extends Method> =
  Operation<P, M> extends { parameters: { path: infer T } } ? { path: T } : { path?: undefined };

type Query<P extends keyof paths, M extends Method> =
  Operation<P, M> extends { parameters: { query?: infer T } } ? { query?: T } : { query?: undefined };

export type Options<P extends keyof paths, M extends Method> = PathParams<P, M> &
  Query<P, M> & { signal?: AbortSignal };
