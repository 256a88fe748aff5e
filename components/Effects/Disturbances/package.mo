within Effects;
package Disturbances "What has no form: a source at every place, so that coloured disturbances are not taken for effects"
end Disturbances;
