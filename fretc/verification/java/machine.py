"""A monitor in Java, run by a virtual machine, with memory for one state in this process.

Each message has the cells of both approximations and the inputs of a tick. The answer has the cells
after it, and the outcome.
"""

from __future__ import annotations

import os
import struct
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

from fretc.verification.compiled.memory import OUTCOME, MonitorMemory
from fretc.verification.compiled.plan import RequirementPosition
from fretc.verification.compiled.tools import conversation, no_answer
from fretish.classes.frozen import dataclass

EXPLORER = "FretcExplorer"
"""The class that steps a monitor."""
FLAGS = ("-XX:+UseSerialGC", "-XX:-UsePerfData", "-Xmx512m", "-cp", "classes")
EXPLORER_TEXT = """
import java.io.BufferedInputStream;
import java.io.BufferedOutputStream;
import java.io.DataInputStream;
import java.io.DataOutputStream;
import java.io.IOException;
import java.lang.reflect.Constructor;
import java.lang.reflect.Field;
import java.lang.reflect.Method;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;

/** Steps a monitor from states that are given; it ends when its input ends. */
final class FretcExplorer {
    private static final String[] READING = {
        "left", "violated", "failed", "trigger", "violation", "open", "satisfied_forever", "answer"
    };
    private static final String[] OUTCOME = {"verdict", "finite", "obligation_pending"};
    private final DataInputStream in = new DataInputStream(new BufferedInputStream(System.in));
    private final DataOutputStream out = new DataOutputStream(new BufferedOutputStream(System.out));

    private static Field field(Class<?> type, String name) throws ReflectiveOperationException {
        Field field = type.getDeclaredField(name);
        field.setAccessible(true);
        return field;
    }

    private static Object made(Class<?> type) throws ReflectiveOperationException {
        Constructor<?> constructor = type.getDeclaredConstructor();
        constructor.setAccessible(true);
        return constructor.newInstance();
    }

    private Field[] fields(Class<?> type) throws IOException, ReflectiveOperationException {
        Field[] fields = new Field[in.readInt()];
        for (int i = 0; i < fields.length; i++) {
            fields[i] = field(type, in.readUTF());
        }
        return fields;
    }

    private static int size(Object value) {
        int words = value instanceof int[] ? ((int[]) value).length : 1;
        return value instanceof Boolean ? 1 : 4 * words;
    }

    private static void save(Object approximation, Field[] cells, ByteBuffer image)
        throws ReflectiveOperationException {
        for (Field cell : cells) {
            Object value = cell.get(approximation);
            if (value instanceof Boolean) {
                image.put((byte) ((Boolean) value ? 1 : 0));
            } else if (value instanceof Integer) {
                image.putInt((Integer) value);
            } else {
                for (int word : (int[]) value) {
                    image.putInt(word);
                }
            }
        }
    }

    private static void load(Object approximation, Field[] cells, ByteBuffer image)
        throws ReflectiveOperationException {
        for (Field cell : cells) {
            if (cell.getType() == boolean.class) {
                cell.setBoolean(approximation, image.get() != 0);
            } else if (cell.getType() == int.class) {
                cell.setInt(approximation, image.getInt());
            } else {
                int[] words = (int[]) cell.get(approximation);
                for (int i = 0; i < words.length; i++) {
                    words[i] = image.getInt();
                }
            }
        }
    }

    /** All that an outcome has, in the order of the record: first that of a reading. */
    private static Field[] record(Class<?> reading, Class<?> outcome)
        throws ReflectiveOperationException {
        Field[] fields = new Field[READING.length + OUTCOME.length];
        for (int i = 0; i < READING.length; i++) {
            fields[i] = field(reading, READING[i]);
        }
        for (int i = 0; i < OUTCOME.length; i++) {
            fields[READING.length + i] = field(outcome, OUTCOME[i]);
        }
        return fields;
    }

    private static void put(ByteBuffer record, Field[] fields, Object reading)
        throws ReflectiveOperationException {
        record.putInt(fields[0].getInt(reading));
        for (int i = 1; i < READING.length; i++) {
            record.put((byte) (fields[i].getBoolean(reading) ? 1 : 0));
        }
        record.put((byte) 0);
    }

    private static int code(Field field, Object outcome) throws ReflectiveOperationException {
        return ((Enum<?>) field.get(outcome)).ordinal();
    }

    private void explore(String name) throws IOException, ReflectiveOperationException {
        Class<?> type = Class.forName(name);
        Class<?> inputsType = Class.forName(name + "$Inputs");
        Class<?> outcomesType = Class.forName(name + "$Outcomes");
        Object monitor = made(type);
        Object inputs = made(inputsType);
        Object outcomes = made(outcomesType);
        Object[] approximations = {
            field(type, "certain").get(monitor), field(type, "possible").get(monitor)
        };
        Field[] cells = fields(approximations[0].getClass());
        Field[] given = fields(inputsType);
        Object outcome = field(outcomesType, in.readUTF()).get(outcomes);
        Object certain = field(outcome.getClass(), "certain").get(outcome);
        Object possible = field(outcome.getClass(), "possible").get(outcome);
        Field[] told = record(certain.getClass(), outcome.getClass());
        Object[] truths = Class.forName(name + "$Truth").getEnumConstants();
        Method step = type.getMethod("step", inputsType, outcomesType);
        int size = 0;
        for (Field cell : cells) {
            int own = size(cell.get(approximations[0]));
            out.writeInt(own);
            size += own;
        }
        ByteBuffer image = ByteBuffer.allocate(2 * size).order(ByteOrder.nativeOrder());
        ByteBuffer record = ByteBuffer.allocate(32).order(ByteOrder.nativeOrder());
        byte[] codes = new byte[given.length];
        for (Object approximation : approximations) {
            save(approximation, cells, image);
        }
        out.write(image.array());
        out.flush();
        while (true) {
            in.readFully(image.array());
            in.readFully(codes);
            image.rewind();
            for (Object approximation : approximations) {
                load(approximation, cells, image);
            }
            for (int i = 0; i < codes.length; i++) {
                given[i].set(inputs, truths[codes[i]]);
            }
            step.invoke(monitor, inputs, outcomes);
            image.rewind();
            for (Object approximation : approximations) {
                save(approximation, cells, image);
            }
            record.rewind();
            put(record, told, certain);
            put(record, told, possible);
            record.putInt(code(told[READING.length], outcome));
            record.put((byte) code(told[READING.length + 1], outcome));
            record.put((byte) code(told[READING.length + 2], outcome));
            out.write(image.array());
            out.write(record.array());
            out.flush();
        }
    }

    public static void main(String[] arguments) throws IOException, ReflectiveOperationException {
        new FretcExplorer().explore(arguments[0]);
    }
}
"""


@dataclass(frozen=True, slots=True)
class JavaClass:
    """A compiled class in the folder `classes`."""

    program: str
    """Path of `java`."""
    folder: Path
    """Folder that the caller removes, also if the virtual machine or fretc is killed."""
    name: str
    """Name of the class, with its package."""
    cells: tuple[str, ...]
    inputs: tuple[str, ...]
    outcomes: tuple[str, ...]

    @contextmanager
    def running(self, plan: RequirementPosition) -> Iterator[JavaMemory]:
        """The class, run by a virtual machine until the end of the context.

        Raises:
            ToolError: the virtual machine cannot be started, or ends.
        """
        complaints = self.folder / "errors.txt"
        with complaints.open("wb") as errors, _started(self, errors) as process:
            yield JavaMemory(self, plan, _Conversation(process, complaints))


def _started(java: JavaClass, errors: Any) -> AbstractContextManager[subprocess.Popen[bytes]]:
    """Start the virtual machine without options of the user, which could load agents."""
    plain = {name: value for name, value in os.environ.items() if not name.endswith("JAVA_OPTIONS")}
    plain.pop("JAVA_TOOL_OPTIONS", None)
    command = [java.program, *FLAGS, EXPLORER, java.name]
    return conversation("`java`", command, java.folder, plain, errors)


class _Conversation:
    """Messages to the virtual machine, and its answers."""

    def __init__(self, process: subprocess.Popen[bytes], errors: Path) -> None:
        """The process before the first message, and the file with its errors."""
        assert process.stdin is not None
        assert process.stdout is not None
        self._process, self._errors = process, errors
        self._input, self._output = process.stdin, process.stdout

    def send(self, message: bytes | bytearray) -> None:
        """Send a message."""
        with suppress(BrokenPipeError):  # Then the process has ended without an answer.
            self._input.write(message)
            self._input.flush()

    def receive(self, size: int) -> bytes:
        """So many bytes of the answer.

        Raises:
            ToolError: the virtual machine does not answer.
        """
        answer = self._output.read(size)
        if len(answer) == size:
            return answer
        raise no_answer("`java`", self._process, self._errors, ("Exception", "Error"))


class JavaMemory(MonitorMemory):
    """The cells of a class, which are sent with each tick."""

    def __init__(
        self, java: JavaClass, plan: RequirementPosition, conversation: _Conversation
    ) -> None:
        """The class before the first tick.

        Raises:
            ToolError: the virtual machine does not answer.
        """
        cells = [name for name in java.cells if name in plan.needed]
        self._conversation = conversation
        self._codes = bytearray(len(java.inputs))
        outcome = _text(java.outcomes[plan.outcome])
        conversation.send(_texts(cells) + _texts(java.inputs) + outcome)
        sizes = struct.unpack(f">{len(cells)}i", conversation.receive(4 * len(cells)))
        self._size = sum(sizes)
        self._image = bytearray(conversation.receive(2 * self._size))
        places = [(start, end - start) for start, end in pairwise(accumulate(sizes, initial=0))]
        super().__init__(dict(zip(cells, places, strict=True)), plan)

    def read(self, approximation: int, places: Sequence[tuple[int, int]]) -> bytes:
        """Bytes of an approximation at some offsets."""
        start = approximation * self._size
        return b"".join([self._image[start + at : start + at + size] for at, size in places])

    def write(self, approximation: int, places: Sequence[tuple[int, int]], saved: bytes) -> None:
        """Replace bytes of an approximation."""
        start, done = approximation * self._size, 0
        for at, size in places:
            self._image[start + at : start + at + size] = saved[done : done + size]
            done += size

    def outcome(self, codes: Sequence[tuple[int, int]]) -> bytes:
        """The record of the outcome after a tick."""
        for index, code in codes:
            self._codes[index] = code
        self._conversation.send(self._image + self._codes)
        answer = self._conversation.receive(len(self._image) + OUTCOME.size)
        self._image[:] = answer[: len(self._image)]
        return answer[len(self._image) :]


def _text(text: str) -> bytes:
    """The text as Java reads it."""
    return struct.pack(">H", len(text)) + text.encode("ascii")


def _texts(texts: Sequence[str]) -> bytes:
    return struct.pack(">i", len(texts)) + b"".join(map(_text, texts))
