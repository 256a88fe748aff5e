#!/usr/bin/env python3
"""A second opinion on the shipped Modelica: rumoca reads every example and model, and says what it rejects.

    python3 -m venv VENV && VENV/bin/pip install rumoca
    VENV/bin/python benches/second_opinion.py [CLASS-PART...]

First every file alone (syntax and style), then every class with an `experiment` annotation as a whole. What is rejected
is listed by message. rumoca reads part of the language, so that a rejection is a reason to look, not a verdict:
docs/bench.md says what was found.
"""
import collections
import multiprocessing
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ['components', 'models']
# rumoca compiles in the calling process and cannot be interrupted
SECONDS = 60


def files():
    for folder in FOLDERS:
        yield from sorted((ROOT/folder).rglob('*.mo'))


def runnable():
    """Classes that can run: their name, and the file."""
    for file in files():
        text = file.read_text()
        if 'experiment(' in text and 'partial model' not in text and 'Effects' not in file.parts:
            name = '.'.join(file.relative_to(ROOT).with_suffix('').parts[1:])
            yield name.removeprefix('stiff.'), file


def shape(message):
    """A message without what differs from class to class."""
    message = re.sub(r'\S*\.mo:\d+:\d+', 'FILE', message.split('\n')[0])
    return re.sub(r"[`'\"][^`'\"]*[`'\"]", '..', message)[:160]


def compile_all(cases, out):
    """One session for all, so that the library is read once."""
    import rumoca
    session = rumoca.Session(roots=[str(ROOT/folder) for folder in FOLDERS])
    for name, file in cases:
        try:
            model = session.load(str(file), model=name)
            out.send(('read', f'{len(model.states)} states'))
        except BaseException as e:  # a panic of its own is no Exception
            out.send(('rejected', str(e)))


def opinions(cases):
    """What is said about each case, in order; a case without an answer costs the process, and the next gets a new one."""
    done = 0
    while done < len(cases):
        ours, theirs = multiprocessing.Pipe()
        process = multiprocessing.Process(target=compile_all, args=(cases[done:], theirs))
        process.start()
        theirs.close()
        try:
            while done < len(cases):
                answer = ours.recv() if ours.poll(SECONDS) else ('rejected', f'no answer within {SECONDS} s')
                yield (*cases[done], *answer)
                done += 1
                if answer[1].startswith('no answer'):
                    break
        except EOFError:
            yield (*cases[done], 'rejected', 'the process died')
            done += 1
        process.terminate()
        process.join()


def main(parts):
    try:
        import rumoca
    except ImportError:
        print('skipped: python3 -m pip install rumoca')
        return
    alone = [d for file in files() for d in rumoca.validate(str(file))]
    print(f'{len(list(files()))} files, {len(alone)} remarks')
    for text, count in collections.Counter(shape(str(d)) for d in alone).most_common():
        print(f'  {count:4}  {text}')
    rejected, read = collections.defaultdict(list), 0
    cases = [case for case in runnable() if not parts or any(part in case[0] for part in parts)]
    for name, _, answer, text in opinions(cases):
        print(f'{answer:8}  {name}', file=sys.stderr)
        if answer == 'read':
            read += 1
        else:
            rejected[shape(text)].append((name, text))
    print(f'{read} classes read, {sum(map(len, rejected.values()))} rejected')
    for kind, cases in sorted(rejected.items(), key=lambda item: -len(item[1])):
        print(f'\n{len(cases):4}  {kind}')
        for name, text in cases[:3]:
            print(f'      {name}: ' + text.replace('\n', '\n        ')[:600])


if __name__ == '__main__':
    main(sys.argv[1:])
