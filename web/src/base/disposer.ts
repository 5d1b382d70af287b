// Who makes something registers how it ends; the newest ends first. One disposer per owner.

export interface Disposable {
  dispose(): void;
}

/** What `listen` needs of an event target; structural, so that this file does without the DOM library. Any target's own types fit `never`. */
interface ListenTarget {
  addEventListener(type: never, handler: never, options?: never): void;
  removeEventListener(type: never, handler: never, options?: never): void;
}

/** The type of the event `type` of the target, taken from its property `on<type>`. Without such a property the handler says the type. */
type EventOf<Target, Type extends string> =
  Target extends Readonly<Record<`on${Type}`, infer Handler>>
    ? NonNullable<Handler> extends (this: never, event: infer Event) => unknown
      ? Event
      : never
    : never;

/** A method, so that a handler may ask for a more special event, as the DOM's own types allow. */
type HandlerOf<Event> = { handle(event: Event): void }["handle"];

export interface ListenOptions {
  readonly capture?: boolean;
  readonly passive?: boolean;
  readonly once?: boolean;
}

export class Disposer implements Disposable {
  private ends: (() => void)[] = [];
  private over = false;

  /** Runs `dispose` at the end; at once when the end has passed. */
  add(dispose: () => void): void {
    if (this.over) {
      dispose();
      return;
    }
    this.ends.push(dispose);
  }

  /** Disposes of `x` at the end. Returns it. */
  own<T extends Disposable>(x: T): T {
    this.add(() => x.dispose());
    return x;
  }

  /** Listens until the end. */
  listen<Target extends ListenTarget, Type extends string>(
    target: Target,
    type: Type,
    handler: HandlerOf<EventOf<Target, Type>>,
    options?: ListenOptions,
  ): void {
    if (this.over) return;
    // The types were checked by EventOf; `never` only says that we know no more of the target.
    const call = [type as never, handler as never, options as never] as const;
    target.addEventListener(...call);
    this.add(() => target.removeEventListener(...call));
  }

  get disposed(): boolean {
    return this.over;
  }

  /** Everything, newest first. One that throws does not keep the others from ending; the first error is thrown at the end. */
  dispose(): void {
    if (this.over) return;
    this.over = true;
    const errors: unknown[] = [];
    for (let end = this.ends.pop(); end !== undefined; end = this.ends.pop()) {
      try {
        end();
      } catch (error) {
        errors.push(error);
      }
    }
    if (errors.length > 0) throw errors[0];
  }
}
