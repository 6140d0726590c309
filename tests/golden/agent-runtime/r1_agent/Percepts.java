package r1_agent;

import static r1_agent.Reading.*;

import java.util.Arrays;
import java.util.function.Function;

/** What the bindings say of the agent's percepts and actions. The only file that differs by project. */
final class Percepts {

    /** A percept: its name in the agent, and its truth by the numbers of `SIGNALS`. */
    static final class Percept {
        final String name;
        /** Its value while its signals are unknown; null: it is unknown, and the environment requests a stop. */
        final Boolean onUnknown;
        /** Whether an unknown percept is shown: where it is an event that the agent responds to. */
        final boolean isShownUnknown;
        final Function<Reading[], Boolean> truth;

        Percept(String name, Boolean onUnknown, boolean isShownUnknown, Function<Reading[], Boolean> truth) {
            this.name = name;
            this.onUnknown = onUnknown;
            this.isShownUnknown = isShownUnknown;
            this.truth = truth;
        }
    }

    /** What an action publishes. */
    static final class Binding {
        final String action;
        final String topic;
        final String type;
        /** The message in JSON. */
        final String message;

        Binding(String action, String topic, String type, String message) {
            this.action = action;
            this.topic = topic;
            this.type = type;
            this.message = message;
        }
    }

    /** Which service an action calls. */
    static final class Call {
        final String action;
        final String service;
        final String type;
        /** The request in JSON. */
        final String request;
        /** Nanoseconds for the answer. */
        final long limit;

        Call(String action, String service, String type, String request, long limit) {
            this.action = action;
            this.service = service;
            this.type = type;
            this.request = request;
            this.limit = limit;
        }
    }

    static final String AGENT = "agilex_agent";
    /** The topic of stop requests, std_msgs/Bool. */
    static final String STOP = "/gwendolen_control";
    /** Nanoseconds between two messages on it. */
    static final long HEARTBEAT = 100000000L;

    static final Signal[] SIGNALS = {
        new Signal(
                "/scan",
                "sensor_msgs/LaserScan",
                new String[] {"ranges"},
                -1,
                "outline",
                new String[] {"drop", "far", "near", "drop"},
                300000000L,
                new String[] {"range_min", "range_max"},
                row -> both(compared(row.get("range_min"), "<=", row.get("x")), compared(row.get("x"), "<=", row.get("range_max"))),
                Arrays.asList(),
                new double[] {1.0, 1.0},
                new double[] {0.0, 0.0, 0.0},
                new double[][] {{0.306, 0.29}, {-0.306, 0.29}, {-0.306, -0.29}, {0.306, -0.29}}),
    };

    static final Percept[] PERCEPTS = {
        new Percept("too_close", null, true, s -> compared(s[0], "<", 0.05000000074505806, 0.05)),
    };

    static final Binding[] ACTIONS = {
        new Binding("stop_moving", "/gwendolen_control", "std_msgs/Bool", "{\"data\":true}"),
        new Binding("undo_stopped", "/gwendolen_control", "std_msgs/Bool", "{\"data\":false}"),
    };

    static final Call[] CALLS = {
    };

    private Percepts() {}
}
