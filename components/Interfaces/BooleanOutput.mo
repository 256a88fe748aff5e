within Interfaces;
connector BooleanOutput = output Boolean "Boolean signal, output";
