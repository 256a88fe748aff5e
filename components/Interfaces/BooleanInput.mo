within Interfaces;
connector BooleanInput = input Boolean "Boolean signal, input";
